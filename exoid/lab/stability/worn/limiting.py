"""Parameters whose uncertainty limits the largest stable amplification."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.torques import TorqueModel

from .draws import draw_truths
from .worn_loop import WornLoop


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
        if _bounded(largest).any() or not covariance.any():
            break
        try:
            draws = draw_truths(model, mean, factor**2 * covariance, 60, seed).parameters  # number of such draws
        except ExoidError:  # hardly any bodies are so far from the mean
            break
        largest = loop.largest(loop.legs(model, draws))
    chosen = np.flatnonzero(_bounded(largest))
    # Number of draws with the smallest amplifications at whose boundaries the gradient is taken.
    chosen = chosen[np.argsort(largest[chosen], kind="stable")][:8]
    if not len(chosen):
        return np.zeros(len(mean))

    def radius(parameters: FloatArray, share: FloatArray) -> FloatArray:
        """Spectral radius of the loop for parameters and shares of the model."""
        return loop.radius(loop.legs(model, parameters), share)

    return np.asarray(
        np.mean([_shares_at(radius, draws[k], 1.0 - 1.0 / float(largest[k]), covariance) for k in chosen], axis=0)
    )


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


def _shares_at(
    radius: Callable[[FloatArray, FloatArray], FloatArray], point: FloatArray, share: float, covariance: FloatArray
) -> FloatArray:
    """Shares of variance at one boundary. The factor ∂ρ/∂s is common to all parameters and cancels."""
    std = np.sqrt(np.diag(covariance))
    step = 0.01 * np.where(std > 0.0, std, 1.0)  # step of the gradient in standard deviations
    around = point + np.vstack([np.diag(step), -np.diag(step)])
    ahead, behind = np.split(radius(around, np.full(len(around), share)), 2)
    return variance_shares(np.where(std > 0.0, (ahead - behind) / (2.0 * step), 0.0), covariance)


def _bounded(largest: FloatArray) -> NDArray[np.bool_]:
    return np.asarray((largest > 0.0) & np.isfinite(largest))
