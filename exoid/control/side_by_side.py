"""Several legs, each under a law of its own, in one run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import Law, State


@dataclass(frozen=True)
class SideBySide:
    """Law k drives rig k: to compare laws, or to try each of many estimates on a rig of its own.

    Attributes:
        laws: One a rig, all of the same rate.

    Raises:
        ExoidError: There is none, or their rates differ.
    """

    laws: tuple[Law, ...]

    def __post_init__(self) -> None:
        """Check the rates."""
        if len({law.rate for law in self.laws}) != 1:
            raise ExoidError(
                f"laws of rates {sorted({law.rate for law in self.laws})} Hz side by side",
                remedy="give laws of one rate, and run others apart",
            )

    @property
    def rate(self) -> float:
        """At which all are sampled [Hz]."""
        return self.laws[0].rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """Torque of each law for its rig [N·m], (n, B)."""
        q, v = np.atleast_2d(state.q.T), np.atleast_2d(state.v.T)
        if len(q) != len(self.laws):
            raise ExoidError(f"{len(self.laws)} laws for {len(q)} rigs", remedy="give one a rig")
        aims = [None if x is None else np.broadcast_to(x.reshape(len(x), -1), q.T.shape).T for x in target]
        columns = []
        for k, law in enumerate(self.laws):
            last = None if state.last is None else np.atleast_2d(state.last.T)[k]
            aim = Target(*(None if x is None else x[k] for x in aims))  # type: ignore[arg-type]
            columns.append(law.torque(State(q[k], v[k], state.time, last), aim))
        return np.array(columns).T.reshape(state.q.shape)
