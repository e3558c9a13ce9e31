"""Several legs in one run, each with a different controller."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Target

from .law import State
from .stateful import AnyLaw, Memory, StatefulLaw, stateful, torque_without_memory


@dataclass(frozen=True)
class SideBySide:
    """Controller k for rig k: to compare controllers, or controllers with different estimates.

    Attributes:
        laws: Controllers with or without memory, one for each rig, all of the same rate.

    Raises:
        ExoidError: There are no controllers, or their rates differ.
    """

    laws: tuple[AnyLaw, ...]

    def __post_init__(self) -> None:
        """Check the rates."""
        if len({law.rate for law in self.laws}) != 1:
            raise BadArgumentError(
                f"controllers of rates {sorted({law.rate for law in self.laws})} Hz side by side",
                remedy="give controllers of one rate, and run others separately",
            )

    @property
    def rate(self) -> float:
        """Sampling rate of all controllers [Hz]."""
        return self.laws[0].rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque of each controller for its rig.

        Args:
            state: Measured state, (n, B), or (n,) for one rig.
            target: Reference at this moment, (n, B) or (n, 1).

        Returns:
            Torque [N·m], of the shape of ``state.q``.

        Raises:
            ExoidError: The number of rigs is not that of the controllers, or a controller has memory.
        """
        inputs = self._inputs(state, target)
        columns = [torque_without_memory(law, *one) for law, one in zip(self.laws, inputs, strict=True)]
        return np.array(columns).T.reshape(state.q.shape)

    def begin(self, state: State) -> tuple[Memory, ...]:
        """Compute the memory of each controller before the first sample.

        Args:
            state: Measured state at the first sample, (n, B), or (n,) for one rig.

        Returns:
            Memories, one for each controller.

        Raises:
            ExoidError: The number of rigs is not that of the controllers.
        """
        return tuple(law.begin(one) for law, one in zip(self._stateful, self._states(state), strict=True))

    def step(self, memory: tuple[Memory, ...], state: State, target: Target) -> tuple[FloatArray, tuple[Memory, ...]]:
        """Compute the torque of each controller for its rig, and the memories.

        Args:
            memory: Memories, one for each controller.
            state: Measured state, (n, B), or (n,) for one rig.
            target: Reference at this moment, (n, B) or (n, 1).

        Returns:
            Torque [N·m], of the shape of ``state.q``, and the memories for the next sample.

        Raises:
            ExoidError: The number of rigs is not that of the controllers.
        """
        inputs = self._inputs(state, target)
        steps = [law.step(own, *one) for law, own, one in zip(self._stateful, memory, inputs, strict=True)]
        return np.array([torque for torque, _ in steps]).T.reshape(state.q.shape), tuple(own for _, own in steps)

    @cached_property
    def _stateful(self) -> tuple[StatefulLaw, ...]:
        """All controllers with memory."""
        return tuple(stateful(law) for law in self.laws)

    def _states(self, state: State) -> list[State]:
        """State of each rig."""
        q, v = np.atleast_2d(state.q.T), np.atleast_2d(state.v.T)
        if len(q) != len(self.laws):
            raise BadArgumentError(f"{len(self.laws)} controllers for {len(q)} rigs", remedy="give one for each rig")
        rest = [len(q) * [None] if x is None else np.atleast_2d(x.T) for x in (state.last, state.interaction)]
        return [State(q[k], v[k], state.time, *(x[k] for x in rest)) for k in range(len(q))]

    def _inputs(self, state: State, target: Target) -> list[tuple[State, Target]]:
        """State and target of each rig."""
        states, shape = self._states(state), np.atleast_2d(state.q.T).shape
        aims = [None if x is None else np.broadcast_to(x.reshape(len(x), -1), shape[::-1]).T for x in target]
        return [
            (one, Target(*(None if x is None else x[k] for x in aims)))  # type: ignore[arg-type]
            for k, one in enumerate(states)
        ]
