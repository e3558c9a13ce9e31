"""Limits of torque and of its rate, around any controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import Law, State, spread


@dataclass(frozen=True, eq=False)
class Limited:
    """Another controller within limits: |τ| ≤ ``limit``, |τ − τ_last| ≤ ``slew`` / rate.

    The last command is part of the state, so this controller has no memory either. The controllers of this package do
    not integrate, so there is no windup.

    Attributes:
        law: The other controller.
        limit: Largest torque [N·m], a number or (n,); inf for none.
        slew: Largest rate of change of the torque [N·m/s], likewise. It does not apply to the first sample.

    Raises:
        ExoidError: A limit is not positive.

    Example:
        >>> from exoid.control import Limited, pd
        >>> Limited(pd(1000.0, 0.0), limit=(80.0, 60.0), slew=2000.0).rate
        100.0
    """

    law: Law
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
        """
        torque = self.law.torque(state, target)
        if state.last is not None:
            change = spread(np.asarray(self.slew), torque) / self.rate
            torque = np.clip(torque, state.last - change, state.last + change)
        limit = spread(np.asarray(self.limit), torque)
        return np.clip(torque, -limit, limit)
