"""Faults that were found in a log, with their sizes and what they do to the parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .corrections import CORRECTED
from .least_sizes import SEVERE_SHARE, is_large_enough
from .nuisances import Nuisance
from .score import Score

SMALLEST_MOVE = 0.5
"""A fault matters if it moves a parameter by more than so many half widths of its interval."""

DOUBTFUL_MOVE = 0.25
"""A fault that matters makes all parameters doubtful that it moves by more than this."""

SEVERE = 10.0
"""A fault that moves a parameter by so many half widths is an error."""


class Fault(NamedTuple):
    """A fault that was accepted."""

    nuisance: Nuisance  # the fault
    applied: float = 0.0  # part of it that was taken out of the recordings
    alternatives: tuple[Score, ...] = ()  # faults that explain the log about as well

    @property
    def columns(self) -> tuple[int, ...]:
        """Columns that stay in the fit; none where the fault is taken out of the recordings."""
        return () if is_corrected(self.nuisance) else self.nuisance.columns


class FaultSize(NamedTuple):
    """Size of a fault beside all others, and what it does to the parameters."""

    fault: Fault  # the fault
    delta: FloatArray  # estimate, (m,)
    std: FloatArray  # standard deviations, (m,)
    p_value: float  # probability of a fault as large as this in noise alone
    move: FloatArray  # change of the parameters when the fault is taken into account, (P,)
    half: FloatArray  # half widths of the parameters' intervals, (P,)
    reach: FloatArray  # largest change of the parameters by a fault of this kind, torque and any form, (P,)
    torque: float = 0.0  # RMS torque of the fault over that of its joint
    share: float = 0.0  # RMS torque of the largest change of a parameter over that of a joint

    @property
    def moves(self) -> FloatArray:
        """Changes of the parameters in half widths, (P,)."""
        return self._in_half_widths(self.move)

    @property
    def doubtful(self) -> NDArray[np.bool_]:
        """Which parameters the fault makes doubtful, (P,)."""
        return np.maximum(self.moves, self._in_half_widths(self.reach)) > DOUBTFUL_MOVE

    @property
    def matters(self) -> bool:
        """Whether the fault moves a parameter out of half its interval, and has a size that matters."""
        large = is_large_enough(self.fault.nuisance, self.delta, self.torque)
        return large and bool(self.moves.max(initial=0.0) > SMALLEST_MOVE)

    @property
    def moves_far(self) -> bool:
        """Whether the fault moves a parameter by many half widths."""
        return bool(self.moves.max(initial=0.0) > SEVERE)

    @property
    def severe(self) -> bool:
        """Whether the result is not to be used: a parameter moves far, and by a part of the torque that matters."""
        return self.moves_far and self.share > SEVERE_SHARE

    def _in_half_widths(self, change: FloatArray) -> FloatArray:
        return np.divide(np.abs(change), self.half, out=np.zeros_like(change), where=self.half > 0.0)

    def moving_at_least(self, total: FloatArray) -> FaultSize:
        """Blame this fault for what all faults together move more than it does alone."""
        return self._replace(move=np.where(np.abs(total) > np.abs(self.move), total, self.move))


def is_corrected(nuisance: Nuisance) -> bool:
    """Say whether a fault is taken out of the recordings."""
    return nuisance.kind in CORRECTED and not nuisance.group
