"""Stiffness and damping of the cuffs of a passive limb, estimated beside the limb's parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.estimate import EstimateData
from exoid.estimate.validation_checks import effective_share
from exoid.regression.model import RegressorModel
from exoid.regression.rows import each_row, prepare
from exoid.signals import Preparation, Recording

STEP = 0.02
"""Step of the logarithm of a stiffness or damping for its derivative."""

ITERATIONS = 5
"""Gauss-Newton steps from the stated cuffs."""

FAR = 3.0
"""Standard deviations from the stated value beyond which a note says so."""


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
        k, d = self.stiffness, self.damping
        if not (np.isfinite(k).all() and np.isfinite(d).all() and k.min() > 0.0 and d.min() >= 0.0):
            raise ExoidError(
                f"cuffs of {k.tolist()} N·m/rad and {d.tolist()} N·m·s/rad",
                remedy="give a positive stiffness, such as 1000",
            )
        if not all((np.isfinite(each) & (each >= 0.0)).all() for each in (self.stiffness_std, self.damping_std)):
            raise ExoidError(
                "a relative standard deviation of the cuffs that is negative or not finite",
                remedy="give a number such as 0.2, or 0 for cuffs that are known exactly",
            )
        for array in (k, d, self.stiffness_std, self.damping_std):
            array.flags.writeable = False

    @classmethod
    def of(cls, joint_names: tuple[str, ...], stiffness: ArrayLike, damping: ArrayLike, std: float) -> Cuffs:
        """Make cuffs from one number or one for each joint.

        Args:
            joint_names: Names of the joints, (n,).
            stiffness: Stiffness [N·m/rad], one or (n,).
            damping: Damping [N·m·s/rad], one or (n,).
            std: Relative standard deviation of both.

        Returns:
            The cuffs.

        Raises:
            ExoidError: A value is impossible.
        """
        n = len(joint_names)
        k, d = (np.array(np.broadcast_to(np.asarray(x, dtype=np.float64), n)) for x in (stiffness, damping))
        return cls(joint_names, k, d, np.full(n, float(std)), np.where(d > 0.0, float(std), 0.0))

    @property
    def known(self) -> bool:
        """Whether all values are known exactly."""
        return not (self.stiffness_std.any() or self.damping_std.any())

    def rows(self) -> list[tuple[str, ...]]:
        """Write each cuff as a row of a table.

        Returns:
            One row a joint: stiffness and damping with standard deviations.
        """
        columns = (self.joint_names, self.stiffness, self.stiffness_std, self.damping, self.damping_std)
        return [
            (name, f"{k:.4g}", f"{k * k_std:.2g}", f"{d:.3g}", f"{d * d_std:.2g}")
            for name, k, k_std, d, d_std in zip(*columns, strict=True)
        ]


class FoundCuffs(NamedTuple):
    """Estimated cuffs, and how the limb's parameters depend on them.

    Attributes:
        cuffs: The cuffs.
        limb_covariance: Covariance of the limb's parameters due to the errors of the cuffs, (P, P).
        far: Joints whose cuffs differ from what was stated by more than :data:`FAR` standard deviations.
    """

    cuffs: Cuffs
    limb_covariance: FloatArray
    far: tuple[str, ...]


def estimate_cuffs(
    stated: Cuffs, limb: EstimateData, alone: EstimateData, log_of: Callable[[Cuffs], Recording]
) -> FoundCuffs:
    """Estimate cuffs and limb together by Gauss-Newton, with the stated cuffs as prior.

    The limb obeys −τ_w = W(q_l(θ)) β, with θ the logarithms of stiffness and damping. About θ,

        −τ_w ≈ W β + D δθ,      D = ∂(W β)/∂θ.

    Rows are weighted by residuals and count by their independent samples. The prior of θ is normal about the stated
    values. Errors δ of the leg's own parameters add W_leg δ to −τ_w; they are not fitted, but their effect is part of
    the covariance of θ.

    Args:
        stated: Cuffs as stated, with relative standard deviations.
        limb: Estimate of the limb with these cuffs.
        alone: Estimate of the leg alone.
        log_of: Function that computes the log of the limb from cuffs.

    Returns:
        The cuffs, and the covariance that their errors add to the limb's parameters.
    """
    spread = np.concatenate([stated.stiffness_std, stated.damping_std])
    free = np.flatnonzero(spread)
    values, spread = np.concatenate([stated.stiffness, stated.damping]), spread[free]
    centre = np.log(values[free])

    def cuffs_at(theta: FloatArray, std: FloatArray) -> Cuffs:
        at, widths = values.copy(), np.zeros_like(values)
        at[free], widths[free] = np.exp(theta), std
        return Cuffs(stated.joint_names, *np.split(at, 2), *np.split(widths, 2))

    def rows_at(theta: FloatArray, model: RegressorModel = limb.model) -> tuple[FloatArray, FloatArray]:
        return _rows(model, log_of(cuffs_at(theta, spread)), limb.preparation)

    theta, beta, (W, tau) = centre, limb.values, rows_at(centre)
    D = np.stack([(rows_at(theta + STEP * unit)[0] - W) @ beta / STEP for unit in np.eye(len(free))], axis=-1)
    counts = _independent(limb, log_of(stated))
    for _ in range(ITERATIONS):
        theta, beta, *_ = _step(W, D, tau, np.sqrt(counts) / (tau - W @ beta).std(axis=0), theta, centre, spread)
        W, tau = rows_at(theta)
    weights = np.sqrt(counts) / (tau - W @ beta).std(axis=0)
    theta, beta, covariance, gain = _step(W, D, tau, weights, theta, centre, spread)
    of_leg = gain @ _stacked(rows_at(theta, alone.model)[0], weights)  # error of θ by errors of the leg
    covariance = covariance + of_leg @ alone.covariance @ of_leg.T
    slope = -np.linalg.lstsq(_stacked(W, weights), _stacked(D, weights), rcond=None)[0]  # ∂β/∂θ
    beyond = free[np.abs(theta - centre) > FAR * spread]
    far = dict.fromkeys(stated.joint_names[k % len(stated.joint_names)] for k in beyond)
    return FoundCuffs(cuffs_at(theta, np.sqrt(np.diag(covariance))), slope @ covariance @ slope.T, tuple(far))


def _independent(limb: EstimateData, log: Recording) -> FloatArray:
    """Share of the samples behind the filter that are independent, (n,)."""
    shares = [effective_share(limb, joint) for joint in range(len(limb.joint_names))]
    return limb.preparation.independent_fraction(log.sample_rate) * np.array(shares)


def _rows(model: RegressorModel, log: Recording, preparation: Preparation) -> tuple[FloatArray, FloatArray]:
    """Columns and torque of a log behind the filter, (N, n, P) and (N, n)."""
    parts = list(each_row(model, prepare(model, log, preparation, every=True)))
    return np.concatenate([part.W for part in parts]), np.concatenate([part.tau for part in parts])


def _stacked(columns: FloatArray, weights: FloatArray) -> FloatArray:
    """Weighted rows of all joints below each other, (N n, P)."""
    return np.asarray((columns * weights[:, None]).reshape(-1, columns.shape[-1]))


class _Step(NamedTuple):
    """Solution of the linearised problem: θ, β, covariance of θ for given β_leg, and θ by weighted torques (p, N n)."""

    theta: FloatArray
    beta: FloatArray
    covariance: FloatArray
    gain: FloatArray


def _step(
    W: FloatArray,
    D: FloatArray,
    tau: FloatArray,
    weights: FloatArray,
    theta: FloatArray,
    centre: FloatArray,
    spread: FloatArray,
) -> _Step:
    """Solve τ = W β + D δθ by weighted least squares, with the prior θ + δθ ~ N(centre, spread²)."""
    A, P = np.hstack([_stacked(W, weights), _stacked(D, weights)]), W.shape[-1]
    information, pull = A.T @ A, np.zeros(A.shape[1])
    information[P:, P:] += np.diag(spread**-2.0)
    pull[P:] = (centre - theta) / spread**2
    scale = 1.0 / np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information * np.outer(scale, scale)) * np.outer(scale, scale)
    found = covariance @ (A.T @ (tau * weights).ravel() + pull)
    return _Step(theta + found[P:], found[:P], covariance[P:, P:], covariance[P:] @ A.T)
