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


def bounded(
    wanted: FloatArray,
    last: FloatArray | float,
    most: FloatArray,
    fastest: FloatArray,
    dt: float,
    jerk: FloatArray | float = np.inf,
    slope: FloatArray | float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Torque after dt within ± ``most``, and its rate, within ± ``fastest``, which changes by ``jerk`` dt at most."""
    error = np.clip(wanted, -most, most) - last
    # the rate is √(jerk |error|) at most, so that the torque can stop at its aim
    fastest = np.minimum(fastest, np.sqrt(jerk * np.maximum(np.abs(error), 1e-300)))
    rate = np.clip(np.clip(error / dt, -fastest, fastest), slope - jerk * dt, slope + jerk * dt)
    torque = last + rate * dt
    return np.clip(torque, -most, most), np.where(np.abs(torque) > most, 0.0, rate)


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
        """Check controller and limits."""
        stateful(self.law)
        for name in ("limit", "slew"):
            object.__setattr__(self, name, checked(getattr(self, name), name, above=0.0, infinite=True))

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.law.rate

    def begin(self, state: State) -> Memory:
        """Compute the memory before the first sample.

        Args:
            state: First measured state.

        Returns:
            Memory of the other controller, and the last torque, which is zero.
        """
        return stateful(self.law).begin(state), np.zeros(np.shape(state.q))

    def step(self, memory: Memory, state: State, target: Target) -> tuple[FloatArray, Memory]:
        """Compute the torque within the limits, and the next memory.

        Args:
            memory: Memory after the last sample.
            state: Measured state.
            target: Reference at this moment.

        Returns:
            Torque [N·m], (n,), and memory.
        """
        inner, last = memory
        last = last if state.last is None else state.last
        state = state._replace(last=last)
        torque, inner = stateful(self.law).step(inner, state, target)
        sound(torque - last, state)
        limit, slew = (spread(np.asarray(x), torque) for x in (self.limit, self.slew))
        torque, _ = bounded(torque, last, limit, slew, 1.0 / self.rate)
        return torque, (inner, torque)

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
