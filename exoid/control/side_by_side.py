"""Several legs in one run, each with a different controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import Law, State


@dataclass(frozen=True)
class SideBySide:
    """Controller k for rig k: to compare controllers, or controllers with different estimates.

    Attributes:
        laws: Controllers, one for each rig, all of the same rate.

    Raises:
        ExoidError: There are no controllers, or their rates differ.
    """

    laws: tuple[Law, ...]

    def __post_init__(self) -> None:
        """Check the rates."""
        if len({law.rate for law in self.laws}) != 1:
            raise ExoidError(
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
            ExoidError: The number of rigs is not that of the controllers.
        """
        q, v = np.atleast_2d(state.q.T), np.atleast_2d(state.v.T)
        if len(q) != len(self.laws):
            raise ExoidError(f"{len(self.laws)} controllers for {len(q)} rigs", remedy="give one for each rig")
        aims = [None if x is None else np.broadcast_to(x.reshape(len(x), -1), q.T.shape).T for x in target]
        columns = []
        for k, law in enumerate(self.laws):
            last = None if state.last is None else np.atleast_2d(state.last.T)[k]
            aim = Target(*(None if x is None else x[k] for x in aims))  # type: ignore[arg-type]
            columns.append(law.torque(State(q[k], v[k], state.time, last), aim))
        return np.array(columns).T.reshape(state.q.shape)
