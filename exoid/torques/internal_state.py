"""Internal states of a joint, which depend on all of its motion before."""

from __future__ import annotations

from abc import ABC, abstractmethod

from exoid._typing import FloatArray


class InternalState(ABC):
    """Internal state of a joint, computed over a whole recording in time order.

    Equal objects are one state: terms of a joint share it.
    """

    @abstractmethod
    def states(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the state at each sample.

        Args:
            q: Angle of the joint [rad], (N,), in time order.
            v: Velocity of the joint [rad/s], (N,).

        Returns:
            State at each sample, (N,).
        """
