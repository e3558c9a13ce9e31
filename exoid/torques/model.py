"""The whole torque of a leg: rigid-body dynamics and the terms beside it, as columns times parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.torso import TorsoMotion

from .memory import Memory
from .motion import JointMotion, Motion
from .nonlinear import nonlinear_settings
from .term import Term

BLOCK = 32768
"""Samples worked on at once."""

DEPENDENT = 1e-9
"""A unit column this close to the span of those before it is dependent on them."""


class Regrouped(NamedTuple):
    """A parameter that no motion can tell from others, and therefore became part of them.

    Attributes:
        name: The parameter.
        into: Names of the parameters that contain it, with its share in each.
    """

    name: str
    into: dict[str, float]

    def __str__(self) -> str:
        """Say it in words."""
        share = ", ".join(n if abs(c - 1.0) < 1e-6 else f"{n} (× {c:.3g})" for n, c in self.into.items())
        return f"{self.name} cannot be told from {share} by any motion: it is part of it"


class JointTerm(NamedTuple):
    """One term at one joint.

    Attributes:
        term: The term.
        joint: Index of the joint.
        names: Of its parameters.
    """

    term: Term
    joint: int
    names: tuple[str, ...]


class LegMotion(NamedTuple):
    """Motion of all joints over some samples, (n, N) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s].
        a: Accelerations [rad/s²].
        load: Rigid-body torques [N·m].
        states: Hidden states, (N,) each.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    load: FloatArray
    states: Mapping[tuple[int, Memory], FloatArray]

    def of(self, block: JointTerm) -> JointMotion:
        """Pick what a term may know."""
        joint, memory = block.joint, block.term.memory
        state = None if memory is None else self.states[joint, memory]
        return JointMotion(self.q[joint], self.v[joint], self.a[joint], self.load[joint], state)


@dataclass(frozen=True, eq=False)
class TorqueModel:
    """τ = W(q, v, a) β with β = (leg parameters, term parameters).

    Attributes:
        leg: The rigid bodies.
        terms: What acts on the joints besides.
        rigid: Leg parameters whose torque loads the joints, (p,), for terms that depend on it; None for the leg's own.
    """

    leg: Leg
    terms: tuple[Term, ...]
    rigid: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check that each parameter has one name, and each setting a number."""
        names = self.every_name
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            raise ExoidError(f"parameters occur twice: {', '.join(repeated)}", remedy="give each term once a joint")
        free = nonlinear_settings(self.terms, self.leg.joint_names, self.leg.joint_labels)
        if free:
            raise ExoidError(
                f"settings are still to be found: {', '.join(shape.name for shape in free)}",
                remedy="give them numbers, or identify, which finds them",
            )

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joints of the leg, (n,)."""
        return self.leg.joint_names

    @property
    def joint_labels(self) -> tuple[str, ...]:
        """Names that parameters call the joints by, (n,)."""
        return self.leg.joint_labels

    @property
    def every_name(self) -> tuple[str, ...]:
        """Names of all parameters, those that are regrouped too."""
        return (*self.leg.parameter_names, *(name for block in self.blocks for name in block.names))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters, in the order of the columns."""
        return tuple(self._units)

    @property
    def units(self) -> tuple[str, ...]:
        """Their units."""
        return tuple(self._units.values())

    @property
    def loaded(self) -> bool:
        """Whether a term depends on the rigid-body torque, so that W depends on :attr:`rigid`."""
        return any(block.term.loaded for block in self.blocks)

    @cached_property
    def regrouped(self) -> tuple[Regrouped, ...]:
        """Parameters of terms that are part of others, whatever the motion (a rotor at the hip is part of J1).

        Terms that depend on the load are left to the fit: what they can be told from depends on the parameters.
        """
        count = len(self.leg.parameter_names)
        every = self.every_name
        loaded = {name for block in self.blocks if block.term.loaded for name in block.names}
        motion = self.motion(*_some_motion(10 * len(every), len(self.leg.joint_names)))
        W = self._fill(motion, every).transpose(2, 1, 0).reshape(-1, len(every))
        scale = np.linalg.norm(W, axis=0)
        scale = np.where(scale > 0.0, scale, 1.0)
        W = np.asarray(np.linalg.qr(W / scale, mode="r"))  # as small as can be: a seven-joint arm has 80 columns
        kept, regrouped = list(range(count)), []
        for k in (k for k in range(count, len(every)) if every[k] not in loaded):
            share, *_ = np.linalg.lstsq(W[:, kept], W[:, k])
            if W[:, k].any() and np.linalg.norm(W[:, k] - W[:, kept] @ share) < DEPENDENT:
                shares = zip(kept, share * scale[k] / scale[kept], strict=True)
                regrouped.append(Regrouped(every[k], {every[i]: float(s) for i, s in shares if abs(s) > DEPENDENT}))
            else:
                kept.append(k)
        return tuple(regrouped)

    def loaded_by(self, values: FloatArray) -> TorqueModel:
        """Return the same model with joints loaded by the rigid-body torque of these parameters, (P,)."""
        return replace(self, rigid=values[: len(self.leg.parameter_names)]) if self.loaded else self

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which parameters can act on which joint, (n, P); columns are zero elsewhere."""
        joints, rigid = len(self.leg.joint_names), self.leg.parameter_names
        acting = np.zeros((joints, len(self.names)), dtype=np.bool_)
        acting[:, : len(rigid)] = self.leg.regressor(*_some_motion(10, joints)).any(axis=0)
        for block in self.blocks:
            acting[block.joint, [self.names.index(name) for name in block.names if name in self.names]] = True
        return acting

    @cached_property
    def nonnegative(self) -> NDArray[np.bool_]:
        """Which parameters cannot be negative in nature: friction and rotor inertia, (P,)."""
        never = {
            name
            for block in self.blocks
            for symbol, name in zip(block.term.symbols, block.names, strict=True)
            if symbol in block.term.nonnegative
        }
        return np.array([name in never for name in self.names], dtype=np.bool_)

    @cached_property
    def friction(self) -> NDArray[np.bool_]:
        """Which parameters are those of friction, (P,)."""
        names = {name for block in self.blocks if block.term.friction for name in block.names}
        return np.array([name in names for name in self.names], dtype=np.bool_)

    def own_parameters(self, joint: int) -> tuple[str, ...]:
        """Parameters that only a motion of the joint shows; none if the leg's cannot be told by joint.

        They are those of the segment that follows it and of its terms, without what acts at rest too.
        """
        if self.leg.chain is None:
            return ()
        parameters = [*self.leg.parameter_names[3 * joint : 3 * joint + 3]]
        for block in self.blocks:
            columns = np.zeros((len(block.names), 2))
            block.term.fill(JointMotion(*np.zeros((5, 2))), columns)
            if block.joint == joint:
                parameters += [name for name, column in zip(block.names, columns, strict=True) if not column.any()]
        return tuple(name for name in parameters if name in self.names)

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: TorsoMotion | None = None) -> FloatArray:
        """Columns of all parameters, (N, n, P); arguments as for :meth:`exoid.Leg.regressor`.

        Terms with a memory, such as presliding, take the samples in time order.
        """
        return self.columns(self.motion(q, v, a, torso)).transpose(2, 1, 0)

    def motion(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: TorsoMotion | None = None) -> Motion:
        """Gather what the columns of a whole recording depend on, hidden states too; arguments as there."""
        q, v, a = self.leg.samples(q, v, a)
        needed = {(block.joint, block.term.memory) for block in self._remembering}
        states = {(j, memory): memory.states(q[:, j], v[:, j]) for j, memory in needed if memory is not None}
        return Motion(q, v, a, torso, states)

    def columns(self, motion: Motion) -> FloatArray:
        """Columns of all parameters for a motion or some rows of it, each contiguous in memory, (P, n, N).

        A model that is linearised has one more: torque that is known.
        """
        return self._fill(motion, self.names)

    def friction_torque(self, motion: Motion, values: FloatArray) -> FloatArray:
        """Part of the torque that is friction [N·m], (N, n), of a motion however long.

        Args:
            motion: See :meth:`motion`.
            values: Of all parameters, (P,).
        """
        torque = np.zeros(motion.q.shape)
        for start in range(0, len(torque), BLOCK):
            rows = slice(start, start + BLOCK)
            columns = self.columns(motion.rows(rows))[self.friction]
            torque[rows] = np.tensordot(values[self.friction], columns, axes=1).T
        return torque

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which joint's sample can be identified from, given velocities [rad/s], (N, n)."""
        usable = np.ones(v.shape, dtype=np.bool_)
        for block in self.blocks:
            usable[:, block.joint] &= block.term.usable(v[:, block.joint])
        return usable

    @cached_property
    def blocks(self) -> tuple[JointTerm, ...]:
        """Terms joint by joint, in the order of the columns."""
        names, labels = self.leg.joint_names, self.leg.joint_labels
        return tuple(
            JointTerm(term, joint, tuple(f"{symbol}_{labels[joint]}" for symbol in term.symbols))
            for term in self.terms
            for joint in term.joint_indices(names, labels)
        )

    @cached_property
    def _units(self) -> dict[str, str]:
        units = dict(zip(self.leg.parameter_names, self.leg.parameter_units, strict=True))
        for block in self.blocks:
            units.update(zip(block.names, block.term.units, strict=True))
        for regrouped in self.regrouped:
            del units[regrouped.name]
        return units

    @property
    def _known_columns(self) -> int:
        """Columns beyond those of the parameters."""
        return 0

    @property
    def _remembering(self) -> tuple[JointTerm, ...]:
        """Blocks whose hidden states are needed."""
        return self.blocks

    def _fill(self, motion: Motion, names: tuple[str, ...]) -> FloatArray:
        """Columns of the named parameters, of which the leg's are the first."""
        q, v, a, torso, _ = motion
        out = np.zeros((len(names) + self._known_columns, *q.shape[::-1]))
        self.leg.fill_regressor(q, v, a, out[: len(self.leg.parameter_names)], torso)
        for start in range(0, len(q), BLOCK):
            rows = slice(start, start + BLOCK)
            self._fill_terms(self._leg_motion(motion.rows(rows), out[..., rows]), out[..., rows], names)
        return out

    def _leg_motion(self, motion: Motion, columns: FloatArray) -> LegMotion:
        """Samples of a motion with their loads, from the rigid bodies' columns, (p or more, n, N)."""
        load = np.broadcast_to(0.0, motion.q.shape[::-1])
        if self.loaded:
            rigid = self.leg.parameters if self.rigid is None else self.rigid
            load = np.tensordot(rigid, columns[: len(rigid)], axes=1)
        return LegMotion(motion.q.T, motion.v.T, motion.a.T, load, motion.states)

    def _fill_terms(self, motion: LegMotion, out: FloatArray, names: tuple[str, ...]) -> None:
        """Write the terms' columns below those of the rigid bodies, (P or more, n, N)."""
        row = len(self.leg.parameter_names)
        for block in self.blocks:
            kept = [k for k, name in enumerate(block.names) if name in names]
            rows = slice(row, row + len(kept))
            whole = len(kept) == len(block.names)
            columns = out[rows, block.joint] if whole else np.zeros((len(block.names), out.shape[2]))
            block.term.fill(motion.of(block), columns)
            if not whole:
                out[rows, block.joint] = columns[kept]
            row = rows.stop


def _some_motion(samples: int, joints: int) -> FloatArray:
    """Angles, velocities and accelerations that have nothing to do with each other, (3, N, n)."""
    motion = np.random.default_rng(0).standard_normal((3, samples, joints))
    return motion * [[[1.0]], [[2.0]], [[5.0]]]
