"""Nuisance columns: how the torque would change if the log or the model had a fault.

For a small fault δ the torque is τ = W β + z δ, with z the derivative of the predicted torque by the fault: −dτ/dt for
a torque that is late, ∂τ/∂q for an angle zero, ∂τ/∂L for a segment's length. The columns stand beside those of the
parameters, pass the same filter, and are tested in :mod:`exoid.identification.findings.score`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.dynamics import TorqueSlopes, gravity_torque, inverse_dynamics_slopes
from exoid.leg.leg import Leg
from exoid.torques import Coulomb, Motion, TorqueModel

from .arm_columns import ArmColumns

STEP = 1e-4
"""Step of finite differences [rad, or a part of the quantity]."""

WIDTH = 0.05
"""Width of friction columns where the model has no Coulomb friction [rad/s]."""

SLOW = 0.25
"""Stribeck friction is tested with a velocity of this part of the RMS speed."""

FEW_JOINTS = 4
"""Up to so many joints cross-talk and forces that depend on other joints are tested."""


FRICTION = ("sharpness", "friction |v|", "friction v²", "friction Stribeck", "friction load")
"""Columns of one joint's velocity."""


FORCES = ("force", "force²")
"""Columns of the angles, for elastic forces."""


class Column(NamedTuple):
    """One nuisance column.

    Attributes:
        kind: What it is the derivative by.
        place: Index of the joint or segment.
        rows: Joints on whose torque it acts, (n,).
        other: Index of another joint; −1 for none.
    """

    kind: str
    place: int
    rows: tuple[bool, ...]
    other: int = -1


@dataclass(frozen=True, eq=False)
class NuisanceColumns:
    """Nuisance columns of a torque model."""

    model: TorqueModel  # the torque model
    values: FloatArray  # parameters at which derivatives are taken, (P,)
    rate: float  # sampling rate [Hz]
    speed: FloatArray  # RMS speed of each joint [rad/s], (n,)
    moving: bool = True  # whether samples are a motion in time; False for poses
    # moment arms of linear actuators, by the index of their joint
    arms: Mapping[int, ArmColumns] = field(default_factory=dict)

    @cached_property
    def layout(self) -> tuple[Column, ...]:
        """What each column is, K of them."""
        return column_layout(self.model, self.arms)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, (K,)."""
        return tuple(f"{column.kind} {column.place} {column.other}" for column in self.layout)

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, K)."""
        return np.array([column.rows for column in self.layout], dtype=np.bool_).T

    def motion(self, motion: Motion) -> Motion:
        """Return the motion: the columns depend on nothing else."""
        return motion

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write the columns."""
        rigid, count = len(self.model.leg.parameter_names), len(self.values)
        of_leg = np.tensordot(self.values[:rigid], columns[:rigid], axes=1)
        torque = of_leg + np.tensordot(self.values[rigid:], columns[rigid:count], axes=1)
        work = _Work(self, motion, torque, of_leg)
        for column, of_column in zip(self.layout, out, strict=True):
            work.fill(column, of_column)


@dataclass(frozen=True, eq=False)
class _Work:
    """Columns of one block of samples."""

    of: NuisanceColumns
    motion: Motion
    torque: FloatArray
    of_leg: FloatArray

    def fill(self, column: Column, out: FloatArray) -> None:
        """Write one column, (n, N)."""
        j, motion = column.place, self.motion
        v = motion.v[:, j].T if column.kind in FRICTION else None
        match column.kind:
            case "delay":
                if self.of.moving:
                    out[j] = -_derivative(self.torque[j]) * self.of.rate
            case "gain":
                out[j] = self.torque[j]
            case "cross-talk":
                out[j] = self.torque[column.other]
            case "zero":
                out[:] = self._by_angle(j)
            case "scale":
                out[:] = self._by_scale(j)
            case "gravity":
                out[:] = _gravity_change(self._fitted_leg, motion.q, j)
            case "length":
                out[:] = self._lengthened(j)
            case "clock":
                out[:] = self._faster()
            case "arm":
                out[j] = self._arm_shapes[j][column.other] * self.torque[j]
            case "force" | "force²":
                out[j] = motion.q[:, column.other] if column.kind == "force" else motion.q[:, j] ** 2
            case _:
                assert v is not None
                out[j] = self._friction(column.kind, j, v)

    def _friction(self, kind: str, j: int, v: FloatArray) -> FloatArray:
        """Friction of other forms than Coulomb's and viscous friction."""
        width, slow = _width(self.of.model), SLOW * max(float(self.of.speed[j]), 1e-6)
        match kind:
            case "sharpness":
                return np.tanh(4.0 * v / width)
            case "friction |v|":
                return np.abs(v)
            case "friction v²":
                return v * np.abs(v)
            case "friction Stribeck":
                return np.tanh(v / width) * np.exp(-((v / slow) ** 2))
            case _:
                return np.asarray(np.tanh(v / width) * np.abs(self.of_leg[j]))

    def _by_angle(self, j: int) -> FloatArray:
        """Derivative of the rigid-body torque by an angle, (n, N)."""
        if not self.of.model.leg.limbs:
            return self._slopes.q[:, :, j].T
        return np.asarray((self._changed[j] - self.of_leg) / STEP)

    def _by_scale(self, j: int) -> FloatArray:
        """Derivative of the rigid-body torque by the scale of an angle and its derivatives, (n, N)."""
        motion = self.motion
        if not self.of.model.leg.limbs:
            pairs = zip(self._slopes, (motion.q, motion.v, motion.a), strict=True)
            return np.asarray(sum(slope[:, :, j].T * x[:, j] for slope, x in pairs))
        return np.asarray((self._changed[motion.q.shape[1] + j] - self.of_leg) / STEP)

    @cached_property
    def _arm_shapes(self) -> dict[int, FloatArray]:
        """Relative changes of the moment arms, (2, N) each."""
        return {j: arm.shapes(self.motion.q[:, j]) for j, arm in self.of.arms.items()}

    @cached_property
    def _slopes(self) -> TorqueSlopes:
        """Derivatives of the rigid-body torque of a leg that is not planar."""
        motion = self.motion
        return inverse_dynamics_slopes(self._fitted_leg.model, motion.q, motion.v, motion.a)

    @cached_property
    def _changed(self) -> FloatArray:
        """Rigid-body torque of a planar leg with the angle of each joint off by a step, then scaled, (2 n, n, N)."""
        samples, n = self.motion.q.shape
        several = Motion(*self.motion[:4]).rows(np.tile(np.arange(samples), 2 * n))
        q, v, a = (x.reshape(2 * n, samples, n) for x in several[:3])
        for j in range(n):
            q[j, :, j] += STEP
            for x in (q, v, a):
                x[n + j, :, j] *= 1.0 + STEP
        torque = _planar_torque(self.of.model.leg, self.of.values, several)
        return torque.reshape(n, 2 * n, samples).transpose(1, 0, 2)

    def _lengthened(self, j: int) -> FloatArray:
        """Derivative of the torque by the relative length of a segment, (n, N)."""
        leg = self.of.model.leg
        assert leg.chain is not None
        offsets = leg.chain.offsets.copy()
        offsets[j] *= 1.0 + STEP
        longer = replace(leg, chain=replace(leg.chain, offsets=offsets))
        return (_planar_torque(longer, self.of.values, self.motion) - self.of_leg) / STEP

    def _faster(self) -> FloatArray:
        """Derivative of the torque by the relative speed of the clock, (n, N): all but gravity goes with its square."""
        leg = self.of.model.leg
        if not leg.limbs:
            return 2.0 * (self.of_leg - gravity_torque(self._fitted_leg.model, self.motion.q).T)
        still = np.zeros_like(self.motion.v)
        slow = self.motion._replace(v=still, a=still)
        return 2.0 * (self.of_leg - _planar_torque(leg, self.of.values, slow))

    @cached_property
    def _fitted_leg(self) -> Leg:
        leg = self.of.model.leg
        return leg.with_parameters(self.of.values[: len(leg.parameter_names)])


def column_layout(model: TorqueModel, arms: Collection[int] = ()) -> tuple[Column, ...]:
    """List the nuisance columns of a model."""
    n, planar = len(model.joint_names), model.leg.chain is not None
    every = (True,) * n
    columns = []
    for j in range(n):
        own = tuple(k == j for k in range(n))
        columns += [Column("delay", j, own), Column("gain", j, own), Column("zero", j, every)]
        columns += [Column("scale", j, every)]
        columns += [Column(kind, j, own) for kind in FRICTION]
        columns += [Column("force", j, own, k) for k in range(n) if k == j or n <= FEW_JOINTS]
        columns += [Column("force²", j, own)]
        if n <= FEW_JOINTS:
            columns += [Column("cross-talk", j, own, k) for k in range(n) if k != j]
        if planar and j < n - 1:
            columns += [Column("length", j, every)]
        if j in arms:
            columns += [Column("arm", j, own, k) for k in range(2)]
    if not planar:
        columns += [Column("gravity", k, every) for k in range(2)]
    if n > 2 or (n > 1 and not planar):  # of a planar leg of two segments it is that of the length
        columns += [Column("clock", 0, every)]
    return tuple(columns)


def _planar_torque(leg: Leg, values: FloatArray, motion: Motion) -> FloatArray:
    """Rigid-body torque of a planar leg, (n, N)."""
    count = len(leg.parameter_names)
    out = np.zeros((count, *motion.q.shape[::-1]))
    leg.fill_regressor(motion.q, motion.v, motion.a, out, motion.torso)
    return np.asarray(np.tensordot(values[:count], out, axes=1))


def _gravity_change(leg: Leg, q: FloatArray, axis: int) -> FloatArray:
    """Derivative of the gravity torque by a tilt about one of two horizontal axes, (n, N)."""
    model = leg.model.copy()
    gravity = np.array(model.gravity.linear)
    up = -gravity / np.linalg.norm(gravity)
    first = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    directions = (first / np.linalg.norm(first), np.cross(up, first / np.linalg.norm(first)))
    model.gravity.linear = np.cross(directions[axis], gravity)
    return gravity_torque(model, q).T


def _derivative(x: FloatArray) -> FloatArray:
    """Difference of fourth order per sample, (N,)."""
    if len(x) < 5:
        return np.asarray(np.gradient(x)) if len(x) > 1 else np.zeros_like(x)
    d = np.gradient(x)
    d[2:-2] = (8.0 * (x[3:-1] - x[1:-3]) - (x[4:] - x[:-4])) / 12.0
    return np.asarray(d)


def _width(model: TorqueModel) -> float:
    """Width of the model's Coulomb friction [rad/s]."""
    for term in model.terms:
        if isinstance(term, Coulomb) and isinstance(term.smoothing, float) and term.smoothing > 0.0:
            return term.smoothing
    return WIDTH
