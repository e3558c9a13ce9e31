"""Limits of torque and of its rate, around any controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import State, spread
from .stateful import AnyLaw, Memory, stateful, torque_without_memory


@dataclass(frozen=True, eq=False)
class Limited:
    """Another controller within limits: |τ| ≤ ``limit``, |τ − τ_last| ≤ ``slew`` / rate.

    The last command is part of the state, so that the limits need no memory. A controller that integrates finds the
    torque that was really commanded in ``state.last``.

    Attributes:
        law: The other controller, with or without memory.
        limit: Largest torque [N·m], a number or (n,); inf for none.
        slew: Largest rate of change of the torque [N·m/s], likewise. The torque before the first sample is zero: the
            drives carry nothing yet, and a first command that jumps is what the limit is for.

    Raises:
        ExoidError: A limit is not positive.

    Example:
        >>> from exoid.control import Limited, pd
        >>> Limited(pd(1000.0, 0.0), limit=(80.0, 60.0), slew=2000.0).rate
        100.0
    """

    law: AnyLaw
    limit: ArrayLike = np.inf
    slew: ArrayLike = np.inf

    def __post_init__(self) -> None:
        """Check the limits."""
        for name in ("limit", "slew"):
            array = np.array(getattr(self, name), dtype=np.float64)
            if array.ndim > 1 or not (array > 0.0).all():
                raise ExoidError(f"{name} = {getattr(self, name)!r}", remedy="give positive limits, or inf")
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.law.rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque of the other controller, within the limits.

        Args:
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``.

        Raises:
            ExoidError: The other controller has memory.
        """
        return self._within(torque_without_memory(self.law, state, target), state)

    def begin(self, state: State) -> Memory:
        """Compute the memory of the other controller before the first sample.

        Args:
            state: Measured state at the first sample, (n,) or (n, B).

        Returns:
            The memory.
        """
        return stateful(self.law).begin(state)

    def step(self, memory: Memory, state: State, target: Target) -> tuple[FloatArray, Memory]:
        """Compute the torque of the other controller, within the limits, and its memory.

        Args:
            memory: Memory of the other controller.
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``, and the memory for the next sample.
        """
        torque, memory = stateful(self.law).step(memory, state, target)
        return self._within(torque, state), memory

    def _within(self, torque: FloatArray, state: State) -> FloatArray:
        last = np.zeros_like(torque) if state.last is None else state.last
        change = spread(np.asarray(self.slew), torque) / self.rate
        torque = np.clip(torque, last - change, last + change)
        limit = spread(np.asarray(self.limit), torque)
        return np.clip(torque, -limit, limit)
