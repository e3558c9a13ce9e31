"""Stiffness and damping of the cuffs of a passive limb, estimated beside the limb's parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.estimate import EstimateData
from exoid.estimate.validation_checks import effective_share
from exoid.regression.every_row import make_rows
from exoid.regression.model import RegressorModel
from exoid.regression.row_data import Rows
from exoid.signals import Recording
from exoid.tools.numbers import checked


@dataclass(frozen=True, eq=False, repr=False)
class Cuffs:
    """Stiffness and damping of the cuffs at each joint.

    Attributes:
        joint_names: Names of the joints, (n,).
        stiffness: Stiffness k [N·m/rad], (n,).
        damping: Damping d [N·m·s/rad], (n,).
        stiffness_std: Relative standard deviation of the stiffness, (n,).
        damping_std: Relative standard deviation of the damping, (n,); 0 where no damping was stated.
    """

    joint_names: tuple[str, ...]
    stiffness: FloatArray
    damping: FloatArray
    stiffness_std: FloatArray
    damping_std: FloatArray

    def __post_init__(self) -> None:
        """Check the values and forbid changes."""
        checked(self.stiffness, "stiffness of the cuffs", above=0.0)
        for name in ("damping", "stiffness_std", "damping_std"):
            checked(getattr(self, name), f"{name} of the cuffs", least=0.0)
        for name in ("stiffness", "damping", "stiffness_std", "damping_std"):
            getattr(self, name).flags.writeable = False

    @classmethod
    def of(cls, joint_names: tuple[str, ...], stiffness: ArrayLike, damping: ArrayLike, std: float) -> Cuffs:
        """Make cuffs from one number or one for each joint; zero damping counts as known."""
        n = len(joint_names)
        k, d = (np.array(np.broadcast_to(np.asarray(x, dtype=np.float64), n)) for x in (stiffness, damping))
        return cls(joint_names, k, d, np.full(n, float(std)), np.where(d > 0.0, float(std), 0.0))

    @property
    def known(self) -> bool:
        """Whether all values are known exactly."""
        return not (self.stiffness_std.any() or self.damping_std.any())

    def rows(self) -> list[tuple[str, ...]]:
        """Write stiffness and damping of each cuff, with standard deviations, as a row of a table."""
        columns = (self.joint_names, self.stiffness, self.stiffness_std, self.damping, self.damping_std)
        return [
            (name, f"{k:.4g}", f"{k * k_std:.2g}", f"{d:.3g}", f"{d * d_std:.2g}")
            for name, k, k_std, d, d_std in zip(*columns, strict=True)
        ]


class FoundCuffs(NamedTuple):
    """Estimated cuffs, and how the limb's parameters depend on them."""

    cuffs: Cuffs  # the cuffs
    limb_covariance: FloatArray  # covariance of the limb's parameters due to the errors of the cuffs, (P, P)
    far: tuple[str, ...]  # joints whose cuffs differ from what was stated by more than three standard deviations


LimbLog = Callable[[Cuffs, FloatArray | None], Recording]
"""Log of the limb in some cuffs. The torque of the log bends them, or, given β, the torque that a limb needs which
moves as the leg does: noise of the torque is not part of that."""


def estimate_cuffs(stated: Cuffs, limb: EstimateData, alone: EstimateData, log_of: LimbLog) -> FoundCuffs:
    """Estimate cuffs and limb together, with the stated cuffs as prior."""
    # The limb obeys −τ_w = W(q_l(θ)) β, with θ the logarithms of stiffness and damping. About θ,
    #
    #     −τ_w ≈ W β + D δθ,      D = ∂(W β)/∂θ.
    #
    # Noise of τ_w bends the cuffs of the model too, so that it is in W and D: least squares would choose the cuffs that
    # hide it. W and D of a predicted torque are therefore the instruments Z (Söderström and Stoica 1989):
    #
    #     Zᵀ Ω (−τ_w − W β − D δθ) = 0.
    #
    # Rows are weighted by residuals and count by their independent samples. The prior of θ is normal about the stated
    # values. Errors δ of the leg's own parameters add W_leg δ to −τ_w; they are not fitted, but their effect is part of
    # the covariance of θ.
    spread = np.concatenate([stated.stiffness_std, stated.damping_std])
    free, values = np.flatnonzero(spread), np.concatenate([stated.stiffness, stated.damping])
    spread, centre = spread[free], np.log(values[free])

    def cuffs_at(theta: FloatArray, std: FloatArray) -> Cuffs:
        at, widths = values.copy(), np.zeros_like(values)
        at[free], widths[free] = np.exp(theta), std
        return Cuffs(stated.joint_names, *np.split(at, 2), *np.split(widths, 2))

    def rows_at(theta: FloatArray, beta: FloatArray | None = None, model: RegressorModel = limb.model) -> Rows:
        return make_rows(model, log_of(cuffs_at(theta, spread), beta), limb.preparation)

    def with_slopes(theta: FloatArray, beta: FloatArray, given: FloatArray | None = None) -> FloatArray:
        W, step = rows_at(theta, given).W, 0.02
        slopes = [(rows_at(theta + step * unit, given).W - W) @ beta / step for unit in np.eye(len(free))]
        return np.concatenate([W, np.stack(slopes, axis=-1)], axis=-1)

    rate, joints = log_of(stated, None).sample_rate, range(len(limb.joint_names))
    shares = np.array([effective_share(limb, joint) for joint in joints])
    counts = limb.preparation.independent_fraction(rate) * shares
    theta, beta, tau = centre, limb.values, rows_at(centre).tau
    for _ in range(4):
        A, Z = with_slopes(theta, beta), with_slopes(theta, beta, beta)
        weights = np.sqrt(counts) / (tau - A[..., : len(beta)] @ beta).std(axis=0)
        found = _step(_stacked(A, weights), _stacked(Z, weights), (tau * weights).ravel(), theta, centre, spread)
        theta, beta = found.theta, found.beta
    of_leg = found.gain @ _stacked(rows_at(theta, model=alone.model).W, weights)  # error of θ by errors of the leg
    covariance = found.covariance + of_leg @ alone.covariance @ of_leg.T
    beyond = free[np.abs(theta - centre) > 3.0 * spread]
    far = dict.fromkeys(stated.joint_names[k % len(stated.joint_names)] for k in beyond)
    cuffs = cuffs_at(theta, np.sqrt(np.diag(covariance)))
    return FoundCuffs(cuffs, found.slope @ covariance @ found.slope.T, tuple(far))


def _stacked(columns: FloatArray, weights: FloatArray) -> FloatArray:
    """Weighted rows of all joints below each other, (N n, P)."""
    return np.asarray((columns * weights[:, None]).reshape(-1, columns.shape[-1]))


class _Step(NamedTuple):
    """Solution of the linearised problem."""

    theta: FloatArray  # θ, (p,)
    beta: FloatArray  # β, (P,)
    covariance: FloatArray  # covariance of θ by noise and prior, (p, p)
    gain: FloatArray  # θ by weighted torques, (p, N n)
    slope: FloatArray  # ∂β/∂θ, (P, p)


def _step(
    A: FloatArray, Z: FloatArray, tau: FloatArray, theta: FloatArray, centre: FloatArray, spread: FloatArray
) -> _Step:
    """Solve τ = W β + D δθ, A = (W, D), with instruments Z and the prior θ + δθ ~ N(centre, spread²)."""
    P = A.shape[1] - len(theta)
    prior, pull = np.zeros((A.shape[1],) * 2), np.zeros(A.shape[1])
    prior[P:, P:] = np.diag(spread**-2.0)
    pull[P:] = (centre - theta) / spread**2
    scale = 1.0 / np.linalg.norm(Z, axis=0)
    each = np.outer(scale, scale)
    inverse = np.linalg.inv((Z.T @ A + prior) * each) * each
    found = inverse @ (Z.T @ tau + pull)
    covariance = inverse @ (Z.T @ Z + prior) @ inverse.T
    slope = np.asarray(-np.linalg.solve(Z[:, :P].T @ A[:, :P], Z[:, :P].T @ A[:, P:]))
    return _Step(theta + found[P:], found[:P], covariance[P:, P:], inverse[P:] @ Z.T, slope)
