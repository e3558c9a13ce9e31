"""Motion and parameters together, for given knots: Gauss–Newton on angles and torques, noise levels in turn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.least_squares import RANK_OF_SQUARES, RFactor, Solution
from exoid.torques import TorqueModel

from .motion_system import Levels, MotionState, Moving, System
from .trajectory import Trajectory, eliminate

SETTLED = 1e-3  # parameters move by less than this part of their standard deviation, and noise levels by less


class MotionFit(NamedTuple):
    """Result for given knots."""

    solution: Solution  # β, and its covariance after the motions were eliminated
    spacing: float  # spacing of the knots [s]
    levels: Levels  # noise
    motions: list[FloatArray]  # fitted angles of each recording [rad], (N, n)
    # generalised cross-validation, Σ N ln(mean squared residual / (1 − t)²) over the angles and torques of each
    # joint, t the share of their degrees of freedom that the fit took: what residuals would be at samples that
    # were left out
    criterion: float
    converged: bool  # whether steps had become small
    system: System  # the least-squares problem
    state: MotionState  # motions and β at its solution


def fit_motion(
    model: TorqueModel,
    moving: Sequence[Moving],
    values: FloatArray,
    spacing: float,
    solve: Callable[[RFactor], Solution],
    priors: FloatArray,
    least: Levels,
    settled: float = SETTLED,
) -> MotionFit:
    """Minimise Σ (q_t − q(t))² / σ_q² + Σ (τ_t − W(q(t), q̇(t), q̈(t)) β)² / σ_τ² over splines q(t) and β."""
    # The noise levels follow in turn, σ² = Σ residual² / (N − what the fit took away), with that share from the
    # trace of the hat matrix, estimated by random vectors (the same in every round).
    system = System(model, moving, priors, [Trajectory.on(data.time, spacing) for data in moving], least)
    state = system.begin(values)
    redundancy = max(1, int(np.sum(system.counts())) - sum(c.size for c in state.coefficients) - len(values))
    levels = system.levels(system.residuals(state))
    for _ in range(30):  # Gauss–Newton steps
        rows = system.linearise(state, levels)
        reduced = [eliminate(trajectory, part) for trajectory, part in zip(system.trajectories, rows, strict=True)]
        matrix, gradient = system.join(reduced)
        solution = solve(_as_triangle(matrix, gradient + matrix @ state.values, redundancy))
        before, state, full = state, *system.descend(state, levels, reduced, solution.values - state.values)
        taken = system.taken(rows, reduced, solution.covariance, levels)
        old, levels = levels, system.levels(system.residuals(state), taken)
        std = np.sqrt(np.diag(solution.covariance))
        moved = np.abs(state.values - before.values) / np.where(std > 0.0, std, np.inf)
        changed = max(float(np.abs(np.log(a / b)).max()) for a, b in zip(levels, old, strict=True))
        converged = full and max(float(moved.max()), changed) < settled
        if converged:
            break
    motions = [t.at_samples(c)[0] for t, c in zip(system.trajectories, state.coefficients, strict=True)]
    criterion = system.criterion(system.residuals(state), levels)
    solution = solution._replace(values=state.values)
    return MotionFit(solution, spacing, levels, motions, criterion, converged, system, state)


def _as_triangle(matrix: FloatArray, right: FloatArray, redundancy: int) -> RFactor:
    """Rows of unit noise that have these normal equations, singular ones too: a rotor may have the column of a J."""
    count, scale = len(right), np.sqrt(np.diag(matrix))
    scale = np.where(scale > 0.0, scale, 1.0)
    values, axes = np.linalg.eigh(matrix / np.outer(scale, scale))
    root = np.sqrt(np.where(values > RANK_OF_SQUARES * values[-1], values, 0.0))
    inverse = np.divide(1.0, root, out=np.zeros_like(root), where=root > 0.0)
    R = np.zeros((count + 1, count + 1))
    rows = np.column_stack([root[:, None] * axes.T * scale, inverse * (axes.T @ (right / scale))])
    R[:count], R[count, count] = np.linalg.qr(rows, mode="r"), np.sqrt(redundancy)
    return RFactor(R, redundancy + count, float(redundancy + count))
