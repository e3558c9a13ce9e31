"""Angles and torques of recordings as one least-squares problem in their motions and in β, for given knots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.torso import MovingBase
from exoid.regression.row_data import NoiseKind, RowBlock, Rows
from exoid.regression.rows import rate_class
from exoid.torques import Motion, TorqueModel
from exoid.torques.motion import STEPS

from .trajectory import WIDTH, BorderedRows, ReducedSystem, Trajectory, eliminate

PROBES = 6  # random vectors with which traces are estimated


class LinearisedRows(NamedTuple):
    """Weighted residuals of measured channels, such as angles and torques, and their derivatives by β."""

    columns: Sequence[NDArray[np.intp]]  # parameters that act on each channel, as indices
    blocks: Sequence[RowBlock]  # rows of each recording

    def weight_index(self, kind: NoiseKind, joint: int) -> int:
        """All rows have one weight."""
        return 0

    def recordings(self) -> Iterator[RowBlock]:
        """Go over the rows of each recording."""
        return iter(self.blocks)


class Moving(NamedTuple):
    """What one recording says."""

    time: FloatArray  # [s], (N,)
    q: FloatArray  # measured angles [rad], (N, n)
    tau: FloatArray  # measured torques [N·m], (N, n)
    usable: FloatArray  # 1, or 0 for torques that are left out, (N, n)
    smooth: FloatArray  # angles to begin with [rad], (N, n)
    torso: MovingBase | None  # posture of the torso


class Levels(NamedTuple):
    """Standard deviations of the noise of each joint, (n,) each."""

    angle: FloatArray  # [rad]
    torque: FloatArray  # [N·m]


class MotionState(NamedTuple):
    """Splines of all recordings, and β."""

    coefficients: list[FloatArray]
    values: FloatArray


class Residuals(NamedTuple):
    """Unweighted: angles, torques (zero where not usable); those of all recordings stacked."""

    angle: FloatArray
    torque: FloatArray


class System(NamedTuple):
    """The least-squares problem for given knots."""

    model: TorqueModel
    moving: Sequence[Moving]
    priors: FloatArray
    trajectories: list[Trajectory]
    least: Levels  # no noise level is smaller

    def begin(self, values: FloatArray) -> MotionState:
        """Splines through the smoothed angles."""
        coefficients = [t.through(data.smooth) for t, data in zip(self.trajectories, self.moving, strict=True)]
        return MotionState(coefficients, values)

    def residuals(self, state: MotionState) -> Residuals:
        """What is measured less what is predicted."""
        angle, moving = [], []
        for data, trajectory, coefficients in zip(self.moving, self.trajectories, state.coefficients, strict=True):
            motion = Motion(*trajectory.at_samples(coefficients), data.torso)
            angle.append(data.q - motion.q)
            moving.append((data.tau - torque(self.model.columns(motion), state.values)) * data.usable)
        return Residuals(np.vstack(angle), np.vstack(moving))

    def linearise(self, state: MotionState, levels: Levels) -> list[BorderedRows]:
        """Weighted residuals and derivatives, recording by recording."""
        rows = []
        for data, trajectory, coefficients in zip(self.moving, self.trajectories, state.coefficients, strict=True):
            motion = Motion(*trajectory.at_samples(coefficients), data.torso)
            W, to_motion = respond(self.model, state.values, motion)
            weight = data.usable / levels.torque
            to_motion *= weight[None, :, :, None]
            pairs = zip(to_motion, trajectory.basis, strict=True)
            J = sum(d[:, :, None, :] * near[:, None, :, None] for d, near in pairs)
            residual = (data.tau - torque(W.transpose(2, 1, 0), state.values)) * weight
            angle = (data.q - motion.q) / levels.angle
            J = np.reshape(J, (len(weight), weight.shape[1], -1))
            rows.append(BorderedRows(residual, angle, J, W * weight[..., None], 1.0 / levels.angle))
        return rows

    def join(self, reduced: Sequence[ReducedSystem]) -> tuple[FloatArray, FloatArray]:
        """Add up the normal equations of all recordings."""
        return np.sum([part.matrix for part in reduced], axis=0), np.sum([part.gradient for part in reduced], axis=0)

    def descend(
        self, state: MotionState, levels: Levels, reduced: Sequence[ReducedSystem], step: FloatArray
    ) -> tuple[MotionState, bool]:
        """Go as far along the Gauss–Newton step as the sum of squares falls, and say whether that is all of it."""
        turns = [(part.free - part.coupling @ step).reshape(-1, len(levels.angle)) for part in reduced]
        before, share = self.squares(state, levels), 1.0
        for _ in range(10):  # halvings
            turned = [c + share * turn for c, turn in zip(state.coefficients, turns, strict=True)]
            there = MotionState(turned, state.values + share * step)
            if self.squares(there, levels) <= before * (1.0 + 1e-12):
                return there, share == 1.0
            share *= 0.5
        return state, True

    def squares(self, state: MotionState, levels: Levels) -> float:
        """Weighted sum of squares, priors among them."""
        believed = float(((self.priors @ np.append(state.values, -1.0)) ** 2).sum())
        pairs = zip(self.residuals(state), levels, strict=True)
        return believed + sum(float(((residual / level) ** 2).sum()) for residual, level in pairs)

    def levels(self, residuals: Residuals, taken: FloatArray | float = 0.0) -> Levels:
        """Noise levels, corrected for what the fit has taken away."""
        freedom = np.maximum(np.array(self.counts()) - taken, 1.0)
        sizes = [np.sqrt((x**2).sum(axis=0) / count) for x, count in zip(residuals, freedom, strict=True)]
        return Levels(*map(np.maximum, sizes, self.least))

    def counts(self) -> tuple[FloatArray, FloatArray]:
        """Angles and usable torques of each joint."""
        usable = np.sum([data.usable.sum(axis=0) for data in self.moving], axis=0)
        return np.full_like(usable, sum(len(data.q) for data in self.moving)), usable

    def influence(self, state: MotionState, levels: Levels) -> LinearisedRows:
        """Rows of torques and angles with the motions eliminated, which β is a least-squares estimate of."""
        # A motion answers to β with −H_cc⁻¹ H_cβ. Torques have the rows W − J H_cc⁻¹ H_cβ, and angles −B
        # H_cc⁻¹ H_cβ: an error of any sample moves β by (Σ rowᵀ row)⁻¹ rowᵀ times the error.
        blocks = []
        linear = self.linearise(state, levels)
        for data, trajectory, rows in zip(self.moving, self.trajectories, linear, strict=True):
            coupling = eliminate(trajectory, rows).coupling
            near = trajectory.near(coupling.reshape(trajectory.size, -1, len(state.values)))
            torques = rows.W - rows.J @ near.reshape(len(near), -1, len(state.values))
            angles = -np.einsum("tk,tkjp->tjp", trajectory.basis[0], near) * rows.angle_weight[:, None]
            W, residual = np.concatenate([torques, angles], axis=1), np.hstack([rows.torque, rows.angle])
            usable = np.hstack([data.usable, np.ones_like(data.usable)])
            acting, still = np.ones(W.shape[1:], dtype=np.bool_), np.zeros_like(residual)
            each = Rows(data.time, W, residual + W @ state.values, still, still, usable > 0.0, acting, 1.0)
            blocks.append(RowBlock(NoiseKind(at_rest=False, rate_class=rate_class(data.time)), each))
        return LinearisedRows([np.arange(len(state.values))] * (2 * len(levels.angle)), blocks)

    def criterion(self, residuals: Residuals, levels: Levels) -> float:
        """See :attr:`MotionFit.criterion`; σ² = Σ residual² / (N (1 − t)), and of t only this is needed."""
        total = 0.0
        for residual, level, count, least in zip(residuals, levels, self.counts(), self.least, strict=True):
            mean = np.maximum((residual**2).sum(axis=0) / np.maximum(count, 1.0), np.square(least))
            total += float((count * (4.0 * np.log(level) - np.log(mean))).sum())
        return total

    def taken(
        self, rows: Sequence[BorderedRows], reduced: Sequence[ReducedSystem], covariance: FloatArray, levels: Levels
    ) -> FloatArray:
        """Degrees of freedom that angles and torques of each joint have lost to the fit, (2, n)."""
        rng = np.random.default_rng(0)  # a trace of the hat matrix A is the mean of zᵀ A z over random signs z
        n = len(levels.angle)
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
        values = covariance @ right
        taken = np.zeros((2, n))
        for trajectory, part, eliminated, z, of_motion in zip(
            self.trajectories, rows, reduced, probes, seen, strict=True
        ):
            motion = (eliminated.solve(of_motion) - eliminated.coupling @ values).reshape(-1, n, PROBES)
            near = trajectory.near(motion)
            answer = part.J @ near.reshape(len(near), -1, PROBES) + part.W @ values
            angles = np.einsum("tk,tkjm->tjm", trajectory.basis[0], near) * part.angle_weight[:, None]
            taken[0] += (angles * z[1]).sum(axis=0).mean(axis=-1)
            taken[1] += (answer * z[0]).sum(axis=0).mean(axis=-1)
        return taken


def respond(model: TorqueModel, values: FloatArray, motion: Motion) -> tuple[FloatArray, FloatArray]:
    """Regressor W, (N, n, P), and ∂τ_i/∂(q, v, a)_j of W β by central differences, (3, N, n, n) with joint j last."""
    samples, joints = motion.q.shape
    to_motion = np.empty((3, samples, joints, joints))
    for k, (name, step) in enumerate(zip(("q", "v", "a"), STEPS, strict=True)):
        for joint in range(joints):
            by = step * (np.arange(joints) == joint)
            sides = (motion._replace(**{name: motion[k] + side}) for side in (by, -by))
            above, below = (torque(model.columns(side), values) for side in sides)
            to_motion[k, :, :, joint] = (above - below) / (2.0 * step)
    return model.columns(motion).transpose(2, 1, 0), to_motion


def torque(columns: FloatArray, values: FloatArray) -> FloatArray:
    """W β, (N, n), from columns, (P, n, N)."""
    return np.asarray(np.tensordot(values, columns, axes=1).T)
