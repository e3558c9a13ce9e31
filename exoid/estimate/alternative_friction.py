"""Friction of other forms than the terms of an estimate: columns that stand beside those of its parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.torques import InternalState, Motion, Presliding, Regrouped, TorqueModel

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
class WithAlternatives:
    """Torque model with K more columns, which hold friction of other forms at each joint.

    Column k of joint j is the k-th alternative at this joint, with a coefficient of its own there: presliding z(q),
    sgn(v) exp(−(v / vs)²), v |v| and sgn(v) |τ_rb|.

    Attributes:
        model: The torque model.
        values: Parameters, whose rigid-body torque τ_rb loads the joints, (P,).
        speed: Largest speed of the training [rad/s], (n,).
    """

    model: TorqueModel
    values: FloatArray
    speed: FloatArray

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joints, (n,)."""
        return self.model.joint_names

    @property
    def joint_labels(self) -> tuple[str, ...]:
        """Joint names as they occur in parameter names, (n,)."""
        return self.model.joint_labels

    @property
    def regrouped(self) -> Sequence[Regrouped]:
        """Parameters that are part of others."""
        return self.model.regrouped

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of parameters, then of alternatives, (P + K,)."""
        return (*self.model.names, *(f"alternative {k}" for k in range(COUNT)))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, P + K)."""
        acting = self.model.acting
        return np.hstack([acting, np.ones((len(acting), COUNT), dtype=np.bool_)])

    def motion(self, q: Any, v: Any, a: Any, torso: Any = None) -> Motion:  # noqa: ANN401 - arrays of any kind
        """Gather what the columns of a whole recording depend on.

        Args:
            q: Angles [rad], (N, n), in time order.
            v: Velocities [rad/s], (N, n).
            a: Accelerations [rad/s²], (N, n).
            torso: Motion of the torso, if it moves.

        Returns:
            The motion, with presliding states.
        """
        motion = self.model.motion(q, v, a, torso)
        states: dict[tuple[int, InternalState], FloatArray] = {
            (j, presliding): presliding.states(motion.q[:, j], motion.v[:, j])
            for j in range(motion.q.shape[1])
            for presliding in map(Presliding, LENGTHS)
        }
        return motion._replace(states={**motion.states, **states})

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns of parameters and alternatives.

        Args:
            motion: Motion of N samples, of :meth:`motion`.

        Returns:
            Columns, (P + K, n, N).
        """
        columns = self.model.columns(motion)
        rigid = len(self.model.leg.parameter_names)
        load = np.tensordot(self.values[:rigid], columns[:rigid], axes=1)
        out = np.empty((len(columns) + COUNT, *columns.shape[1:]))
        out[: len(columns)] = columns
        for j, of_joint in enumerate(np.moveaxis(out[len(columns) :], 1, 0)):
            for column, filled in zip(of_joint, self._of_joint(motion, j, load[j]), strict=True):
                column[:] = filled
        return out

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

    def regressor(self, q: Any, v: Any, a: Any, torso: Any = None) -> FloatArray:  # noqa: ANN401 - arrays of any kind
        """Form the columns of parameters and alternatives, samples first.

        Args:
            q: Angles [rad], (N, n), in time order.
            v: Velocities [rad/s], (N, n).
            a: Accelerations [rad/s²], (N, n).
            torso: Motion of the torso, if it moves.

        Returns:
            Columns, (N, n, P + K).
        """
        return self.columns(self.motion(q, v, a, torso)).transpose(2, 1, 0)

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Say which samples of which joint may be fitted.

        Args:
            v: Velocities [rad/s], (N, n).

        Returns:
            Mask, (N, n).
        """
        return self.model.usable(v)

    def reversing(self, v: FloatArray) -> None:
        """Take no reversal out: predictions keep all rows, and forms of friction differ most where joints turn round.

        Args:
            v: Velocities [rad/s], (N, n).
        """
        return
