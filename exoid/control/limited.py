"""Limits of torque and of its rate, around any controller."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.codegen.law_in_c import law_in_c
from exoid.rig import Target
from exoid.tools.numbers import checked

from .law import AnyLaw, Memory, State, sound, spread, stateful


class LimitedMemory(NamedTuple):
    """Memory of limits around a controller: that of the controller itself is ``law``."""

    law: Memory
    last: FloatArray  # last command [N·m], (n,) or (n, B); zero at first


@dataclass(frozen=True, eq=False)
class Limited:
    """Another controller within limits: |τ| ≤ ``limit``, |τ − τ_last| ≤ ``slew`` / rate.

    τ_last is ``state.last``, or the last command of its own where that is None. The other controller finds it in
    ``state.last``: one that integrates or learns needs the torque that was really commanded.

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

    def begin(self, state: State) -> LimitedMemory:
        """Compute the memory before the first sample.

        Args:
            state: First measured state.

        Returns:
            Memory of the other controller, and no torque.
        """
        return LimitedMemory(stateful(self.law).begin(state), np.zeros(np.shape(state.q)))

    def step(self, memory: LimitedMemory, state: State, target: Target) -> tuple[FloatArray, LimitedMemory]:
        """Compute the torque within the limits, and the next memory.

        Args:
            memory: Memory after the last sample.
            state: Measured state.
            target: Reference at this moment.

        Returns:
            Torque [N·m], (n,), and memory.
        """
        last = memory.last if state.last is None else state.last
        state = state._replace(last=last)
        torque, inner = stateful(self.law).step(memory.law, state, target)
        sound(torque - last, state)
        change = spread(np.asarray(self.slew), torque) / self.rate
        limit = spread(np.asarray(self.limit), torque)
        torque = np.clip(np.clip(torque, last - change, last + change), -limit, limit)
        return torque, LimitedMemory(inner, torque)

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
