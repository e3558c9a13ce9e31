"""Nuisance columns: how the torque would change if the log or the model had a fault.

For a small fault δ the torque is τ = W β + z δ, with z the derivative of the predicted torque by the fault: −dτ/dt for
a torque that is late, ∂τ/∂q for an angle zero, ∂τ/∂L for a segment's length. The columns stand beside those of the
parameters, pass the same filter, and are tested in :mod:`exoid.checks.score`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.dynamics import gravity_torque, inverse_dynamics
from exoid.leg import Leg
from exoid.reduction.planar import fill_regressor
from exoid.torques import Coulomb, Regrouped, TorqueModel
from exoid.torques.term import Motion

STEP = 1e-4
"""Step of finite differences [rad, or a part of the quantity]."""

WIDTH = 0.05
"""Width of friction columns where the model has no Coulomb friction [rad/s]."""

SLOW = 0.25
"""Stribeck friction is tested with a velocity of this part of the RMS speed."""

FEW_JOINTS = 4
"""Up to so many joints cross-talk and forces that depend on other joints are tested."""


class Nuisance(NamedTuple):
    """One kind of fault that columns describe.

    Attributes:
        kind: Kind of the finding.
        joint: Name of the joint; "" for all.
        place: Index of the joint, or of the segment; −1 for all.
        unit: Unit of the fault.
        columns: Indices of the columns that it combines.
        group: Whether the columns have a coefficient each; else they share one.
    """

    kind: str
    joint: str
    place: int
    unit: str
    columns: tuple[int, ...]
    group: bool = False

    def matrix(self, count: int) -> FloatArray:
        """Combine columns.

        Args:
            count: Number of all columns, K.

        Returns:
            Weights of the columns, (K, m).
        """
        C = np.zeros((count, len(self.columns) if self.group else 1))
        for k, column in enumerate(self.columns):
            C[column, k if self.group else 0] = 1.0
        return C


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
class Augmented:
    """Torque model with nuisance columns behind those of its parameters.

    Attributes:
        model: The torque model.
        values: Parameters at which derivatives are taken, (P,).
        rate: Sampling rate [Hz].
        speed: RMS speed of each joint [rad/s], (n,).
        moving: Whether samples are a motion in time; False for poses.
    """

    model: TorqueModel
    values: FloatArray
    rate: float
    speed: FloatArray
    moving: bool = True

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joints, (n,)."""
        return self.model.joint_names

    @property
    def joint_labels(self) -> tuple[str, ...]:
        """Names that parameters call the joints by, (n,)."""
        return self.model.joint_labels

    @property
    def regrouped(self) -> tuple[Regrouped, ...]:
        """Parameters that are part of others."""
        return self.model.regrouped

    @cached_property
    def layout(self) -> tuple[Column, ...]:
        """Nuisance columns, K of them."""
        return column_layout(self.model)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of parameters, then of nuisance columns, (P + K,)."""
        return (*self.model.names, *(f"{c.kind} {c.place} {c.other}" for c in self.layout))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, P + K)."""
        return np.hstack([self.model.acting, np.array([column.rows for column in self.layout], dtype=np.bool_).T])

    def motion(self, q: Any, v: Any, a: Any, torso: Any = None) -> Motion:  # noqa: ANN401 - arrays of any kind
        """Gather what the columns of a whole recording depend on.

        Args:
            q: Angles [rad], (N, n).
            v: Velocities [rad/s], (N, n).
            a: Accelerations [rad/s²], (N, n).
            torso: Motion of the torso, if it moves.

        Returns:
            The motion.
        """
        return self.model.motion(q, v, a, torso)

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which samples of which joint may be fitted.

        Args:
            v: Velocities [rad/s], (N, n).

        Returns:
            Mask, (N, n).
        """
        return self.model.usable(v)

    def regressor(self, q: Any, v: Any, a: Any, torso: Any = None) -> FloatArray:  # noqa: ANN401 - arrays of any kind
        """Columns of parameters and nuisances.

        Args:
            q: Angles [rad], (N, n).
            v: Velocities [rad/s], (N, n).
            a: Accelerations [rad/s²], (N, n).
            torso: Motion of the torso, if it moves.

        Returns:
            (N, n, P + K).
        """
        return self.columns(self.motion(q, v, a, torso)).transpose(2, 1, 0)

    def columns(self, motion: Motion) -> FloatArray:
        """Columns of parameters and nuisances.

        Args:
            motion: Motion, or some rows of it.

        Returns:
            (P + K, n, N).
        """
        base = self.model.columns(motion)
        out = np.zeros((len(self.names), *base.shape[1:]))
        out[: len(base)] = base
        rigid = len(self.model.leg.parameter_names)
        of_leg = np.tensordot(self.values[:rigid], base[:rigid], axes=1)
        torque = of_leg + np.tensordot(self.values[rigid:], base[rigid:], axes=1)
        work = _Work(self, motion, torque, of_leg)
        for place, column in enumerate(self.layout, start=len(base)):
            work.fill(column, out[place])
        return out


@dataclass(frozen=True, eq=False)
class _Work:
    """Columns of one block of samples."""

    augmented: Augmented
    motion: Motion
    torque: FloatArray
    of_leg: FloatArray

    def fill(self, column: Column, out: FloatArray) -> None:
        """Write one column, (n, N)."""
        j, motion = column.place, self.motion
        v = motion.v[:, j].T if column.kind in FRICTION else None
        match column.kind:
            case "delay":
                if self.augmented.moving:
                    out[j] = -_derivative(self.torque[j]) * self.augmented.rate
            case "gain":
                out[j] = self.torque[j]
            case "cross-talk":
                out[j] = self.torque[column.other]
            case "zero":
                out[:] = self._moved(q=(j, STEP, 0.0)) / STEP
            case "scale":
                out[:] = self._moved(q=(j, 0.0, STEP), others=True) / STEP
            case "gravity":
                out[:] = _gravity_change(self._fitted_leg, motion.q, j)
            case "length":
                out[:] = self._lengthened(j)
            case "force":
                out[j] = motion.q[:, column.other]
            case "force²":
                out[j] = motion.q[:, j] ** 2
            case _:
                assert v is not None
                out[j] = self._friction(column.kind, j, v)

    def _friction(self, kind: str, j: int, v: FloatArray) -> FloatArray:
        """Friction of other forms than Coulomb's and viscous friction."""
        width, slow = _width(self.augmented.model), SLOW * max(float(self.augmented.speed[j]), 1e-6)
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

    def _moved(self, q: tuple[int, float, float], *, others: bool = False) -> FloatArray:
        """Change of the rigid-body torque when an angle moves by a step, or by a part of itself, (n, N)."""
        j, step, part = q
        motion = self.motion
        arrays = [motion.q.copy(), motion.v, motion.a]
        arrays[0][:, j] += step + part * motion.q[:, j]
        if others:
            for k in (1, 2):
                arrays[k] = arrays[k].copy()
                arrays[k][:, j] *= 1.0 + part
        moved = motion._replace(q=arrays[0], v=arrays[1], a=arrays[2])
        return self._rigid(moved) - self.of_leg

    def _rigid(self, motion: Motion) -> FloatArray:
        """Rigid-body torque with the fitted parameters, (n, N)."""
        leg = self.augmented.model.leg
        if leg.chain is None:
            return inverse_dynamics(self._fitted_leg.model, motion.q, motion.v, motion.a).T
        return _planar_torque(leg, self.augmented.values, motion)

    def _lengthened(self, j: int) -> FloatArray:
        """Derivative of the torque by the relative length of a segment, (n, N)."""
        leg = self.augmented.model.leg
        assert leg.chain is not None
        offsets = leg.chain.offsets.copy()
        offsets[j] *= 1.0 + STEP
        longer = replace(leg, chain=replace(leg.chain, offsets=offsets))
        return (_planar_torque(longer, self.augmented.values, self.motion) - self.of_leg) / STEP

    @cached_property
    def _fitted_leg(self) -> Leg:
        leg = self.augmented.model.leg
        return leg.with_parameters(self.augmented.values[: len(leg.parameter_names)])


FRICTION = ("sharpness", "friction |v|", "friction v²", "friction Stribeck", "friction load")
"""Columns of one joint's velocity."""


def column_layout(model: TorqueModel) -> tuple[Column, ...]:
    """List the nuisance columns of a model.

    Args:
        model: The torque model.

    Returns:
        The columns, K of them.
    """
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
    if not planar:
        columns += [Column("gravity", k, every) for k in range(2)]
    return tuple(columns)


def nuisances(model: TorqueModel, layout: Sequence[Column]) -> tuple[Nuisance, ...]:
    """List the faults that are tested, as combinations of nuisance columns.

    In a planar leg a tilt of the base changes the torque as the zero of the first angle does, so that only one of the
    two is tested.

    Args:
        model: The torque model.
        layout: The nuisance columns.

    Returns:
        The faults.
    """
    names, planar = model.joint_names, model.leg.chain is not None
    places: dict[tuple[str, int], list[int]] = {}
    for k, column in enumerate(layout):
        places.setdefault((column.kind, column.place), []).append(k)
    found = []
    if len(names) > 1:
        every = tuple(places["delay", j][0] for j in range(len(names)))
        found.append(Nuisance("torque-delay", "", -1, "s", every))
    for j, joint in enumerate(names):
        found.append(Nuisance("torque-delay", joint, j, "s", tuple(places["delay", j])))
        found.append(Nuisance("torque-scale", joint, j, "1", tuple(places["gain", j])))
        found.append(Nuisance("angle-scale", joint, j, "1", tuple(places["scale", j])))
        tilts = planar and j == 0
        zero = tuple(places["zero", j])
        found.append(Nuisance("gravity-direction" if tilts else "angle-offset", "" if tilts else joint, j, "rad", zero))
        if ("length", j) in places:
            found.append(Nuisance("segment-length", joint, j, "1", tuple(places["length", j])))
        friction = tuple(places[kind, j][0] for kind in FRICTION[1:])
        found.append(Nuisance("unmodelled-friction", joint, j, "N·m", friction, group=True))
        force = (*places["force", j], *places["force²", j])
        found.append(Nuisance("unmodelled-force", joint, j, "N·m", force, group=True))
        if ("cross-talk", j) in places:
            found.append(Nuisance("cross-talk", joint, j, "1", tuple(places["cross-talk", j]), group=True))
    if not planar:
        tilt = tuple(places["gravity", k][0] for k in range(2))
        found.append(Nuisance("gravity-direction", "", -1, "rad", tilt, group=True))
    return tuple(found)


def always(layout: Sequence[Column]) -> tuple[int, ...]:
    """Nuisance columns that every test contains, so that the sharpness of friction is not taken for another fault.

    Args:
        layout: The nuisance columns.

    Returns:
        Their indices.
    """
    return tuple(k for k, column in enumerate(layout) if column.kind == "sharpness")


def _planar_torque(leg: Leg, values: FloatArray, motion: Motion) -> FloatArray:
    """Rigid-body torque of a planar leg, (n, N)."""
    assert leg.chain is not None
    count = len(leg.parameter_names)
    out = np.zeros((count, *motion.q.shape[::-1]))
    torso = None if motion.torso is None else motion.torso.samples(len(motion.q))
    fill_regressor(leg.chain, motion.q, motion.v, motion.a, out, cumulative=leg.cumulative, torso=torso)
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
