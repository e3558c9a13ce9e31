"""States of a joint that depend on its whole motion before."""

from __future__ import annotations

from abc import ABC, abstractmethod

from exoid._typing import FloatArray


class InternalState(ABC):
    """A hidden state of a joint, computed over a whole recording in time order.

    Memories are values: terms at one joint whose memories are equal share one state.
    """

    @abstractmethod
    def states(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """State at each sample, (N,).

        Args:
            q: Angle [rad], (N,), in time order.
            v: Velocity [rad/s], (N,).
        """
