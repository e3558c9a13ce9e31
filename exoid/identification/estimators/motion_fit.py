"""Motion and parameters together, for given knots: Gauss–Newton on angles and torques, noise levels in turn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.identification.least_squares import Solution
from exoid.identification.rows import Triangle
from exoid.torques import Motion, TorqueModel
from exoid.torso import TorsoMotion

from .bordered import Reduced, Rows, eliminate
from .sensitivity import respond, torque
from .trajectory import WIDTH, Trajectory

ROUNDS = 30
"""Gauss–Newton steps at most."""

HALVINGS = 10
"""A step that does not reduce the sum of squares is halved so often."""

SETTLED = 1e-3
"""Converged when no parameter moves by more than this part of its standard deviation, and no noise level by more."""

PROBES = 6
"""Random vectors with which traces are estimated."""

QUIET = 1e-9
"""Noise below this [rad], or part of the torque, is rounding."""


class Moving(NamedTuple):
    """What one recording says.

    Attributes:
        time: [s], (N,).
        q: Measured angles [rad], (N, n).
        tau: Measured torques [N·m], (N, n).
        usable: 1, or 0 for torques that are left out, (N, n).
        smooth: Angles to begin with [rad], (N, n).
        torso: How the torso was held.
    """

    time: FloatArray
    q: FloatArray
    tau: FloatArray
    usable: FloatArray
    smooth: FloatArray
    torso: TorsoMotion | None


class Still(NamedTuple):
    """Poses, whose angles count as exact: W (K, n, P) and torques [N·m], (K, n)."""

    W: FloatArray
    tau: FloatArray


class Levels(NamedTuple):
    """Standard deviations of the noise of each joint, (n,) each.

    Attributes:
        angle: [rad].
        torque: [N·m].
        still: Of the torques of poses [N·m].
    """

    angle: FloatArray
    torque: FloatArray
    still: FloatArray


class MotionFit(NamedTuple):
    """Result for given knots.

    Attributes:
        solution: β, and its covariance after the motions were eliminated.
        spacing: Of the knots [s].
        levels: Noise.
        motions: Fitted angles of each recording [rad], (N, n).
        criterion: Generalised cross-validation, Σ N ln(mean squared residual / (1 − t)²) over the angles and torques of
            each joint, t the share of their degrees of freedom that the fit took: what residuals would be at samples
            that were left out.
        converged: Whether steps had become small.
    """

    solution: Solution
    spacing: float
    levels: Levels
    motions: list[FloatArray]
    criterion: float
    converged: bool


def fit_motion(
    model: TorqueModel,
    moving: Sequence[Moving],
    still: Sequence[Still],
    values: FloatArray,
    spacing: float,
    solve: Callable[[Triangle], Solution],
    priors: FloatArray,
    settled: float = SETTLED,
) -> MotionFit:
    """Minimise Σ (q_t − q(t))² / σ_q² + Σ (τ_t − W(q(t), q̇(t), q̈(t)) β)² / σ_τ² over splines q(t) and β.

    The noise levels follow in turn, σ² = Σ residual² / (N − what the fit took away), with that share from the trace of
    the hat matrix, estimated by random vectors (the same in every round).

    Args:
        model: With smooth friction.
        moving: Recordings.
        still: Poses.
        values: β to begin with.
        spacing: Of the knots [s].
        solve: For β, with what is known beside the rows.
        priors: Rows of unit variance that it adds, as [W τ], (K, P + 1).
        settled: When to stop.
    """
    system = _System(model, moving, still, priors, [Trajectory.on(data.time, spacing) for data in moving])
    state = system.begin(values)
    levels = system.levels(system.residuals(state), None)
    for _ in range(ROUNDS):
        rows = system.linearise(state, levels)
        reduced = [eliminate(trajectory, part) for trajectory, part in zip(system.trajectories, rows, strict=True)]
        matrix, gradient = system.join(reduced, state, levels)
        solution = solve(_as_triangle(matrix, gradient + matrix @ state.values, system.redundancy(state)))
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
    return MotionFit(solution._replace(values=state.values), spacing, levels, motions, criterion, converged)


def _as_triangle(matrix: FloatArray, right: FloatArray, redundancy: int) -> Triangle:
    """Rows of unit noise that have these normal equations."""
    count = len(right)
    root = np.linalg.cholesky(matrix)
    R = np.zeros((count + 1, count + 1))
    R[:count, :count], R[:count, count] = root.T, np.linalg.solve(root, right)
    R[count, count] = np.sqrt(redundancy)
    return Triangle(R, redundancy + count, float(redundancy + count))


class _State(NamedTuple):
    coefficients: list[FloatArray]
    values: FloatArray


class _Residuals(NamedTuple):
    """Unweighted: angles, torques (zero where not usable), torques of poses; those of all recordings stacked."""

    angle: FloatArray
    torque: FloatArray
    still: FloatArray


class _System(NamedTuple):
    """The least-squares problem for given knots."""

    model: TorqueModel
    moving: Sequence[Moving]
    still: Sequence[Still]
    priors: FloatArray
    trajectories: list[Trajectory]

    def begin(self, values: FloatArray) -> _State:
        """Splines through the smoothed angles."""
        coefficients = [t.through(data.smooth) for t, data in zip(self.trajectories, self.moving, strict=True)]
        return _State(coefficients, values)

    def residuals(self, state: _State) -> _Residuals:
        angle, moving = [], []
        for data, trajectory, coefficients in zip(self.moving, self.trajectories, state.coefficients, strict=True):
            motion = Motion(*trajectory.at_samples(coefficients), data.torso)
            angle.append(data.q - motion.q)
            moving.append((data.tau - torque(self.model.columns(motion), state.values)) * data.usable)
        n = moving[0].shape[1]
        still = [data.tau - data.W @ state.values for data in self.still]
        return _Residuals(np.vstack(angle), np.vstack(moving), np.vstack([np.zeros((0, n)), *still]))

    def linearise(self, state: _State, levels: Levels) -> list[Rows]:
        rows = []
        for data, trajectory, coefficients in zip(self.moving, self.trajectories, state.coefficients, strict=True):
            motion = Motion(*trajectory.at_samples(coefficients), data.torso)
            W, to_motion = respond(self.model, state.values, motion)
            weight = data.usable / levels.torque
            to_motion *= weight[None, :, :, None]
            J = sum(
                d[:, :, None, :] * near[:, None, :, None] for d, near in zip(to_motion, trajectory.basis, strict=True)
            )
            residual = (data.tau - torque(W.transpose(2, 1, 0), state.values)) * weight
            angle = (data.q - motion.q) / levels.angle
            J = np.reshape(J, (len(weight), weight.shape[1], -1))
            rows.append(Rows(residual, angle, J, W * weight[..., None], 1.0 / levels.angle))
        return rows

    def join(self, reduced: Sequence[Reduced], state: _State, levels: Levels) -> tuple[FloatArray, FloatArray]:
        """Add up recordings and poses."""
        matrix = sum((part.matrix for part in reduced), np.zeros((len(state.values),) * 2))
        gradient = sum((part.gradient for part in reduced), np.zeros(len(state.values)))
        for data in self.still:
            W = data.W / levels.still[:, None]
            matrix = matrix + np.einsum("tip,tiq->pq", W, W)
            gradient = gradient + np.einsum("tip,ti->p", W, (data.tau - data.W @ state.values) / levels.still)
        return matrix, gradient

    def descend(
        self, state: _State, levels: Levels, reduced: Sequence[Reduced], step: FloatArray
    ) -> tuple[_State, bool]:
        """Go as far along the Gauss–Newton step as the sum of squares falls, and say whether that is all of it."""
        n = len(levels.angle)
        turns = [(part.free - part.coupling @ step).reshape(-1, n) for part in reduced]
        before, share = self.squares(state, levels), 1.0
        for _ in range(HALVINGS):
            there = _State(
                [c + share * turn for c, turn in zip(state.coefficients, turns, strict=True)],
                state.values + share * step,
            )
            if self.squares(there, levels) <= before * (1.0 + 1e-12):
                return there, share == 1.0
            share *= 0.5
        return state, True

    def squares(self, state: _State, levels: Levels) -> float:
        believed = float(((self.priors @ np.append(state.values, -1.0)) ** 2).sum())
        return believed + sum(
            float(((residual / level) ** 2).sum())
            for residual, level in zip(self.residuals(state), levels, strict=True)
        )

    def levels(self, residuals: _Residuals, taken: FloatArray | None) -> Levels:
        """Noise levels, corrected for what the fit has taken away."""
        taken = np.zeros((3, residuals.angle.shape[1])) if taken is None else taken
        squares = [(residual**2).sum(axis=0) for residual in residuals]
        quiet = QUIET * max(float(np.abs(data.tau).max()) for data in self.moving)
        return Levels(
            *(
                np.maximum(np.sqrt(total / np.maximum(count - lost, 1.0)), least)
                for total, count, lost, least in zip(squares, self.counts(), taken, (QUIET, quiet, quiet), strict=True)
            )
        )

    def redundancy(self, state: _State) -> int:
        """Measured numbers less unknowns."""
        unknown = sum(c.size for c in state.coefficients) + len(state.values)
        return max(1, int(np.sum(self.counts())) - unknown)

    def counts(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Angles, usable torques and poses of each joint."""
        usable = np.sum([data.usable.sum(axis=0) for data in self.moving], axis=0)
        every = np.full_like(usable, sum(len(data.q) for data in self.moving))
        return every, usable, np.full_like(usable, sum(len(data.tau) for data in self.still))

    def criterion(self, residuals: _Residuals, levels: Levels) -> float:
        """See :attr:`MotionFit.criterion`; σ² = Σ residual² / (N (1 − t)), and of t only this is needed."""
        total = 0.0
        for residual, level, count in zip(residuals, levels, self.counts(), strict=True):
            mean = np.maximum((residual**2).sum(axis=0) / np.maximum(count, 1.0), np.finfo(float).tiny)
            total += float((count * (4.0 * np.log(level) - np.log(mean))).sum())
        return total

    def taken(
        self, rows: Sequence[Rows], reduced: Sequence[Reduced], covariance: FloatArray, levels: Levels
    ) -> FloatArray:
        """Degrees of freedom that angles, torques and poses of each joint have lost to the fit, (3, n).

        The trace of a block of the hat matrix A is the mean of zᵀ A z over random signs z.
        """
        rng = np.random.default_rng(0)
        n = len(levels.angle)
        still = [data.W / levels.still[:, None] for data in self.still]
        probes, seen = [], []
        right = np.zeros((len(covariance), PROBES))
        for trajectory, part, eliminated in zip(self.trajectories, rows, reduced, strict=True):
            z = rng.choice([-1.0, 1.0], (2, *part.torque.shape, PROBES))
            local = (part.J.transpose(0, 2, 1) @ z[0]).reshape(len(z[0]), WIDTH, n, PROBES)
            local += trajectory.basis[0][:, :, None, None] * (part.angle_weight[:, None] * z[1])[:, None]
            of_motion = trajectory.overlap(trajectory.grouped(local).sum(axis=1)).reshape(-1, PROBES)
            right += np.einsum("tip,tim->pm", part.W, z[0]) - eliminated.coupling.T @ of_motion
            probes.append(z)
            seen.append(of_motion)
        exact = np.zeros(n)
        for W in still:
            exact += np.einsum("tip,pq,tiq->i", W, covariance, W)
        values = covariance @ right
        taken = np.zeros((3, n))
        for trajectory, part, eliminated, z, of_motion in zip(
            self.trajectories, rows, reduced, probes, seen, strict=True
        ):
            motion = (eliminated.solve(of_motion) - eliminated.coupling @ values).reshape(-1, n, PROBES)
            near = trajectory.near(motion)
            answer = part.J @ near.reshape(len(near), -1, PROBES) + part.W @ values
            angles = np.einsum("tk,tkjm->tjm", trajectory.basis[0], near) * part.angle_weight[:, None]
            taken[0] += (angles * z[1]).sum(axis=0).mean(axis=-1)
            taken[1] += (answer * z[0]).sum(axis=0).mean(axis=-1)
        taken[2] = exact
        return taken
