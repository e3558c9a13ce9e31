"""Draws of true parameters from the distribution of an estimate, and those whose uncertainty limits stability."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError, NotIdentifiableError
from exoid.torques import TorqueModel, Viscous

from .worn_leg import mass_matrices
from .worn_loop import WornLoop

TRIES = 20
"""Draws that may be made for each that is needed."""


class Draws(NamedTuple):
    """Draws of true parameters."""

    parameters: FloatArray  # sets of parameters, (B, P)
    rejected: float  # share of draws that no rigid bodies have


def draw_truths(model: TorqueModel, values: FloatArray, covariance: FloatArray, count: int, seed: int) -> Draws:
    """Draw from N(values, covariance), without those whose mass matrix is not positive definite at random poses."""
    # Viscous friction that is drawn negative becomes zero, as on the rig.
    if not np.isfinite(covariance).all():
        unknown = [name for name, row in zip(model.names, covariance, strict=True) if not np.isfinite(row).all()]
        remedy = "record what determines them"
        what = f"the covariance of {', '.join(unknown)} is not finite"
        raise NotIdentifiableError(what, parameters=tuple(unknown), remedy=remedy)
    rng, n = np.random.default_rng(seed), len(model.joint_names)
    # Number of random poses at which the mass matrix must be positive definite.
    poses = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, n))
    viscous = {name for block in model.blocks if isinstance(block.term, Viscous) for name in block.names}
    bounded = [k for k, name in enumerate(model.names) if name in viscous]
    # Matrix L with L Lᵀ = Σ; Σ may be singular.
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    variances, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    root = scale[:, None] * (vectors * np.sqrt(variances.clip(0.0))) @ vectors.T
    kept: list[FloatArray] = []
    for tries in range(1, TRIES + 1):
        drawn = values + rng.standard_normal((count, len(values))) @ root.T
        drawn[:, bounded] = drawn[:, bounded].clip(0.0)
        kept.extend(drawn[np.linalg.eigvalsh(mass_matrices(model, drawn, poses)).min(axis=(0, 2)) > 0.0])
        if len(kept) >= count:
            return Draws(np.array(kept[:count]), 1.0 - len(kept) / (tries * count))
    raise NotIdentifiableError(
        f"only {len(kept)} of {TRIES * count} draws have a positive definite mass matrix",
        where=model.leg.description.name,
        remedy="identify again with more excitation, or with known masses as priors",
    )


def limiting_shares(
    loop: WornLoop,
    model: TorqueModel,
    mean: FloatArray,
    covariance: FloatArray,
    draws: FloatArray,
    largest: FloatArray,
    seed: int,
) -> FloatArray:
    """Compute how much of the variance of the boundary each parameter explains."""
    # The spectral radius is ρ(β, s) with the share s = 1 − 1/α. Its boundary ρ = 1 determines s(β) with the
    # gradient −(∂ρ/∂β)/(∂ρ/∂s). Shares of variance are the mean over the draws with the smallest
    # amplifications. If no draw has a boundary, draws with wider standard deviations tell which parameter would
    # limit first.
    # Factors of the standard deviations with which draws are made again until some have a boundary.
    for factor in (4.0, 16.0, 64.0):
        if ((largest > 0.0) & np.isfinite(largest)).any() or not covariance.any():
            break
        try:
            draws = draw_truths(model, mean, factor**2 * covariance, 60, seed).parameters  # number of such draws
        except ExoidError:  # hardly any bodies are so far from the mean
            break
        largest = loop.largest(loop.legs(model, draws))
    chosen = np.flatnonzero((largest > 0.0) & np.isfinite(largest))
    # Number of draws with the smallest amplifications at whose boundaries the gradient is taken.
    chosen = chosen[np.argsort(largest[chosen], kind="stable")][:8]
    if not len(chosen):
        return np.zeros(len(mean))

    std = np.sqrt(np.diag(covariance))
    step = 0.01 * np.where(std > 0.0, std, 1.0)  # step of the gradient in standard deviations
    shares = []
    for k in chosen:  # the factor ∂ρ/∂s is common to all parameters and cancels
        around = draws[k] + np.vstack([np.diag(step), -np.diag(step)])
        at = np.full(len(around), 1.0 - 1.0 / float(largest[k]))
        ahead, behind = np.split(loop.radius(loop.legs(model, around), at), 2)
        shares.append(variance_shares(np.where(std > 0.0, (ahead - behind) / (2.0 * step), 0.0), covariance))
    return np.asarray(np.mean(shares, axis=0))


def variance_shares(gradient: FloatArray, covariance: FloatArray) -> FloatArray:
    """Compute by which share the variance of a linear function would fall if one parameter were known exactly."""
    # This is r_i² = (Σ g)_i² / (Σ_ii gᵀ Σ g), the squared correlation of parameter and function. Correlated parameters
    # share what they explain, so the sum may exceed 1.
    std = np.sqrt(np.diag(covariance))
    along = covariance @ gradient
    variance = float(gradient @ along)
    if variance <= 0.0:
        return np.zeros(len(std))
    return np.asarray(np.where(std > 0.0, along / np.where(std > 0.0, std, 1.0), 0.0) ** 2 / variance)
