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
    """Another controller whose torque is changed by a function of the state. It has the memory of that controller."""

    law: AnyLaw  # the other controller, with or without memory

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.law.rate

    @abstractmethod
    def changed(self, torque: FloatArray, state: State) -> FloatArray:
        """Compute what becomes of a torque of the other controller."""

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        return self.changed(torque_without_memory(self.law, state, target), state)

    def begin(self, state: State) -> Memory:
        """Compute the memory of the other controller before the first sample."""
        return stateful(self.law).begin(state)

    def step(self, memory: Memory, state: State, target: Target) -> tuple[FloatArray, Memory]:
        """Compute the torque, and the memory of the other controller."""
        torque, memory = stateful(self.law).step(memory, state, target)
        return self.changed(torque, state), memory
