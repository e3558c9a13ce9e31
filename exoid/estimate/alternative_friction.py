"""Friction of other forms than the terms of an estimate: columns that stand beside those of its parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques import InternalState, Motion, Presliding, TorqueModel
from exoid.torques.with_columns import WithColumns

LENGTHS = (3e-3, 1e-2, 3e-2)
"""Presliding lengths [rad]."""

STRIBECK = (0.1, 0.3)
"""Stribeck velocities, as parts of the largest speed of the training."""

WIDTH = 0.02
"""Velocity over which the sign of the other forms changes [rad/s]."""

KINDS: dict[str, tuple[int, ...]] = {"presliding": (0, 1, 2), "stribeck": (3, 4), "quadratic": (5,), "load": (6,)}
"""Columns of each form of friction."""

COUNT = sum(map(len, KINDS.values()))
"""Number K of columns of each joint."""


@dataclass(frozen=True, eq=False)
class AlternativeFriction:
    """Columns of friction of other forms at each joint, K of them."""

    # Column k of joint j is the k-th alternative at this joint, with a coefficient of its own there: presliding z(q),
    # sgn(v) exp(−(v / vs)²), v |v| and sgn(v) |τ_rb|.

    rigid: FloatArray  # parameters of the rigid bodies, whose torque τ_rb loads the joints, (p,)
    speed: FloatArray  # largest speed of the training [rad/s], (n,)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, (K,)."""
        return tuple(f"alternative {k}" for k in range(COUNT))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint: all, (n, K)."""
        return np.ones((len(self.speed), COUNT), dtype=np.bool_)

    def motion(self, motion: Motion) -> Motion:
        """Add presliding states."""
        states: dict[tuple[int, InternalState], FloatArray] = {
            (j, presliding): presliding.states(motion.q[:, j], motion.v[:, j])
            for j in range(motion.q.shape[1])
            for presliding in map(Presliding, LENGTHS)
        }
        return motion._replace(states={**motion.states, **states})

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write the columns."""
        load = np.tensordot(self.rigid, columns[: len(self.rigid)], axes=1)
        if motion.payload is not None:
            load += motion.payload.T
        for j, of_joint in enumerate(np.moveaxis(out, 1, 0)):
            for column, filled in zip(of_joint, self._of_joint(motion, j, load[j]), strict=True):
                column[:] = filled

    def _of_joint(self, motion: Motion, j: int, load: FloatArray) -> Iterator[FloatArray]:
        """Alternatives at one joint, (N,) each."""
        for length in LENGTHS:
            yield motion.states[j, Presliding(length)]
        v = motion.v[:, j]
        sign = np.tanh(v / WIDTH)
        for part in STRIBECK:
            yield sign * np.exp(-((v / (part * max(self.speed[j], WIDTH))) ** 2))
        yield v * np.abs(v)
        yield sign * np.abs(load)


def with_alternatives(model: TorqueModel, values: FloatArray, speed: FloatArray) -> WithColumns:
    """Add columns of friction of other forms to a torque model."""
    return WithColumns(model, (AlternativeFriction(values[: len(model.leg.parameter_names)], speed),))
