"""Limits of torque and of its rate, around any controller."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.codegen.law_in_c import law_in_c
from exoid.rig import Target
from exoid.tools.numbers import checked

from .law import AnyLaw, Memory, State, sound, spread, stateful


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
            object.__setattr__(self, name, checked(getattr(self, name), name, above=0.0, infinite=True))

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.law.rate

    def begin(self, state: State) -> Memory:
        """Compute the memory of the other controller before the first sample.

        Args:
            state: First measured state.

        Returns:
            Memory.
        """
        return stateful(self.law).begin(state)

    def step(self, memory: Memory, state: State, target: Target) -> tuple[FloatArray, Memory]:
        """Compute the torque within the limits, and the memory of the other controller.

        Args:
            memory: Memory after the last sample.
            state: Measured state.
            target: Reference at this moment.

        Returns:
            Torque [N·m], (n,), and memory.
        """
        torque, memory = stateful(self.law).step(memory, state, target)
        last = np.zeros_like(torque) if state.last is None else state.last
        sound(torque, State(torque, last))
        change = spread(np.asarray(self.slew), torque) / self.rate
        torque = np.clip(torque, last - change, last + change)
        limit = spread(np.asarray(self.limit), torque)
        return np.clip(torque, -limit, limit), memory

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C.

        Args:
            dialect: Precision.

        Returns:
            The other law, within the limits.

        Raises:
            ExoidError: The other law has no form in C.
        """
        inner = law_in_c(self.law, dialect)
        limit, slew = np.minimum(inner.limit, np.asarray(self.limit)), np.minimum(inner.slew, np.asarray(self.slew))
        return replace(inner, limit=limit, slew=slew)
