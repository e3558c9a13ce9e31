"""Base of controllers around another one, whose torque they change."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from exoid._typing import FloatArray
from exoid.rig import Target

from .law import State
from .stateful import AnyLaw, Memory, stateful, torque_without_memory


@dataclass(frozen=True, eq=False)
class Wrapped(ABC):
    """Another controller whose torque is changed by a function of the state. It has the memory of that controller.

    Attributes:
        law: The other controller, with or without memory.
    """

    law: AnyLaw

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.law.rate

    @abstractmethod
    def changed(self, torque: FloatArray, state: State) -> FloatArray:
        """Compute what becomes of a torque of the other controller.

        Args:
            torque: Its torque [N·m], of the shape of ``state.q``.
            state: Measured state, (n,) or (n, B).

        Returns:
            Torque [N·m], of the same shape.
        """

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class.

        Args:
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``.

        Raises:
            ExoidError: The other controller has memory.
        """
        return self.changed(torque_without_memory(self.law, state, target), state)

    def begin(self, state: State) -> Memory:
        """Compute the memory of the other controller before the first sample.

        Args:
            state: Measured state at the first sample, (n,) or (n, B).

        Returns:
            The memory.
        """
        return stateful(self.law).begin(state)

    def step(self, memory: Memory, state: State, target: Target) -> tuple[FloatArray, Memory]:
        """Compute the torque, and the memory of the other controller.

        Args:
            memory: Memory of the other controller.
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``, and the memory for the next sample.
        """
        torque, memory = stateful(self.law).step(memory, state, target)
        return self.changed(torque, state), memory
