"""Draws of true parameters from the distribution of an estimate."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.torques import TorqueModel, Viscous

from .worn_leg import mass_matrices


def draw_truths(
    model: TorqueModel, values: FloatArray, covariance: FloatArray, count: int, seed: int
) -> tuple[FloatArray, float]:
    """Draw from N(values, covariance), (B, P), without those, whose share it returns, that no rigid bodies have."""
    # Their mass matrix is not positive definite at one of 50 random poses.
    # Viscous friction that is drawn negative becomes zero, as on the rig.
    if not np.isfinite(covariance).all():
        unknown = [name for name, row in zip(model.names, covariance, strict=True) if not np.isfinite(row).all()]
        remedy = "record what determines them"
        what = f"the covariance of {', '.join(unknown)} is not finite"
        raise NotIdentifiableError(what, parameters=tuple(unknown), remedy=remedy)
    rng, n = np.random.default_rng(seed), len(model.leg.joint_names)
    poses = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, n))
    viscous = {name for block in model.blocks if isinstance(block.term, Viscous) for name in block.names}
    bounded = [k for k, name in enumerate(model.names) if name in viscous]
    # Matrix L with L Lᵀ = Σ; Σ may be singular.
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    variances, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    root = scale[:, None] * (vectors * np.sqrt(variances.clip(0.0))) @ vectors.T
    kept: list[FloatArray] = []
    tries = 20  # for each draw that is needed
    for tried in range(1, tries + 1):
        drawn = values + rng.standard_normal((count, len(values))) @ root.T
        drawn[:, bounded] = drawn[:, bounded].clip(0.0)
        kept.extend(drawn[np.linalg.eigvalsh(mass_matrices(model, drawn, poses)).min(axis=(0, 2)) > 0.0])
        if len(kept) >= count:
            return np.array(kept[:count]), 1.0 - len(kept) / (tried * count)
    raise NotIdentifiableError(
        f"only {len(kept)} of {tries * count} draws have a positive definite mass matrix",
        where=model.leg.description.name,
        remedy="identify again with more excitation, or with known masses as priors",
    )
