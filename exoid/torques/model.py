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

from .free import free_shapes
from .memory import Memory
from .motion import JointMotion
from .term import Term

BLOCK = 8192
"""Samples worked on at once."""

DEPENDENT = 1e-9
"""A unit column this close to the span of those before it is dependent on them."""


class Merged(NamedTuple):
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


class Block(NamedTuple):
    """One term at one joint.

    Attributes:
        term: The term.
        joint: Index of the joint.
        names: Of its parameters.
    """

    term: Term
    joint: int
    names: tuple[str, ...]


States = Mapping[tuple[int, Memory], FloatArray]
"""Hidden states by joint and memory, over all samples of a motion, (N,) each."""


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
    states: States

    def of(self, block: Block) -> JointMotion:
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
        free = free_shapes(self.terms, self.leg.joint_names, self.leg.joint_labels)
        if free:
            raise ExoidError(
                f"settings are still to be found: {', '.join(shape.name for shape in free)}",
                remedy="give them numbers, or identify, which finds them",
            )

    @property
    def every_name(self) -> tuple[str, ...]:
        """Names of all parameters, those that are merged too."""
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
    def merged(self) -> tuple[Merged, ...]:
        """Parameters of terms that are part of others, whatever the motion (a rotor at the hip is part of J1).

        Terms that depend on the load are left to the fit: what they can be told from depends on the parameters.
        """
        count = len(self.leg.parameter_names)
        every = self.every_name
        loaded = {name for block in self.blocks if block.term.loaded for name in block.names}
        rng = np.random.default_rng(0)
        motion = rng.standard_normal((3, 10 * len(every), len(self.leg.joint_names)))
        q, v, a = motion * [[[1.0]], [[2.0]], [[5.0]]]
        W = self._fill(q, v, a, None, every).reshape(-1, len(every))
        scale = np.linalg.norm(W, axis=0)
        W, scale = W / np.where(scale > 0.0, scale, 1.0), np.where(scale > 0.0, scale, 1.0)
        kept, merged = list(range(count)), []
        for k in (k for k in range(count, len(every)) if every[k] not in loaded):
            share, *_ = np.linalg.lstsq(W[:, kept], W[:, k])
            if W[:, k].any() and np.linalg.norm(W[:, k] - W[:, kept] @ share) < DEPENDENT:
                shares = zip(kept, share * scale[k] / scale[kept], strict=True)
                merged.append(Merged(every[k], {every[i]: float(s) for i, s in shares if abs(s) > DEPENDENT}))
            else:
                kept.append(k)
        return tuple(merged)

    def loaded_by(self, values: FloatArray) -> TorqueModel:
        """Return the same model with joints loaded by the rigid-body torque of these parameters, (P,)."""
        return replace(self, rigid=values[: len(self.leg.parameter_names)]) if self.loaded else self

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, torso: TorsoMotion | None = None) -> FloatArray:
        """Columns of all parameters, (N, n, P); arguments as for :meth:`exoid.Leg.regressor`.

        Terms with a memory, such as presliding, take the samples in time order. A model that is linearised has one
        column more: torque that is known.
        """
        q, v, a = self.leg.samples(q, v, a)
        return self._fill(q, v, a, torso, self.names)

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which joint's sample can be identified from, given velocities [rad/s], (N, n)."""
        usable = np.ones(v.shape, dtype=np.bool_)
        for block in self.blocks:
            usable[:, block.joint] &= block.term.usable(v[:, block.joint])
        return usable

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Terms joint by joint, in the order of the columns."""
        names, labels = self.leg.joint_names, self.leg.joint_labels
        return tuple(
            Block(term, joint, tuple(f"{symbol}_{labels[joint]}" for symbol in term.symbols))
            for term in self.terms
            for joint in term.joint_indices(names, labels)
        )

    @cached_property
    def _units(self) -> dict[str, str]:
        units = dict(zip(self.leg.parameter_names, self.leg.parameter_units, strict=True))
        for block in self.blocks:
            units.update(zip(block.names, block.term.units, strict=True))
        for merged in self.merged:
            del units[merged.name]
        return units

    @property
    def _known_columns(self) -> int:
        """Columns beyond those of the parameters."""
        return 0

    @property
    def _remembering(self) -> tuple[Block, ...]:
        """Blocks whose hidden states are needed."""
        return self.blocks

    def states(self, q: FloatArray, v: FloatArray) -> States:
        """Hidden states over a whole motion in time order, each once.

        Args:
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).
        """
        needed = {(block.joint, block.term.memory) for block in self._remembering}
        return {(j, memory): memory.states(q[:, j], v[:, j]) for j, memory in needed if memory is not None}

    def _fill(
        self, q: FloatArray, v: FloatArray, a: FloatArray, torso: TorsoMotion | None, names: tuple[str, ...]
    ) -> FloatArray:
        """Regressor of the named parameters, of which the leg's are the first."""
        out = np.zeros((len(names) + self._known_columns, *q.shape[::-1]))
        self.leg.fill_regressor(q, v, a, out[: len(self.leg.parameter_names)], torso)
        states = self.states(q, v)
        for start in range(0, len(q), BLOCK):
            rows = slice(start, start + BLOCK)
            motion = self._slice(q[rows].T, v[rows].T, a[rows].T, states, rows, out[..., rows])
            self._fill_terms(motion, out[..., rows], names)
        return out.transpose(2, 1, 0)

    def _slice(
        self, q: FloatArray, v: FloatArray, a: FloatArray, states: States, rows: slice, columns: FloatArray
    ) -> LegMotion:
        """Samples ``rows`` of a motion, (n, N) each, with loads from the rigid bodies' columns, (p or more, n, N)."""
        load = np.zeros_like(q)
        if self.loaded:
            rigid = self.leg.parameters if self.rigid is None else self.rigid
            load = np.tensordot(rigid, columns[: len(rigid)], axes=1)
        return LegMotion(q, v, a, load, {key: state[rows] for key, state in states.items()})

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
