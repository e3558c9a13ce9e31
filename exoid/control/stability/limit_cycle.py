"""Oscillations that do not die: how large, how slow, and whether they last."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.tracking import Tracking
from exoid.errors import ExoidError

SMALLEST = np.deg2rad(0.05)
"""Less than this peak to peak is rest [rad]."""

LASTING = 0.9
"""An oscillation lasts whose second half is at least so large as its first."""


class LimitCycle(NamedTuple):
    """What the error of each joint did in the last part of a run.

    Attributes:
        peak_to_peak: [rad], (n,).
        period: Between upward crossings of the middle [s], (n,); NaN where there are fewer than two.
        lasting: Whether the joint still swings as widely as before, (n,); a decaying oscillation does not.
    """

    peak_to_peak: FloatArray
    period: FloatArray
    lasting: FloatArray

    @property
    def peak_to_peak_deg(self) -> FloatArray:
        """[deg], (n,)."""
        return np.asarray(np.rad2deg(self.peak_to_peak))

    @property
    def exists(self) -> bool:
        """Whether any joint keeps swinging."""
        return bool(self.lasting.any())


def find_limit_cycle(run: Tracking, last: float = 0.5) -> LimitCycle:
    """Look at the last part of a run towards a constant target, or along a periodic one.

    Args:
        run: What happened.
        last: The share of it to look at; it should hold two periods of the oscillation.

    Raises:
        ExoidError: The share is not between 0 and 1, or leaves too few samples.
    """
    if not 0.0 < last <= 1.0:
        raise ExoidError(f"the last {last:g} of a run", remedy="give a share between 0 and 1")
    begin = int((1.0 - last) * len(run.time))
    time, error = run.time[begin:], run.error[begin:]
    if len(time) < 8:
        raise ExoidError(f"{len(time)} samples to look for oscillations in", remedy="run longer, or log more often")
    early, late = (np.ptp(half, axis=0) for half in np.array_split(error, 2))
    lasting = (late > SMALLEST) & (late >= LASTING * early)
    periods = np.array([_period(time, column) for column in error.T])
    return LimitCycle(np.ptp(error, axis=0), periods, lasting)


def _period(time: FloatArray, error: FloatArray) -> float:
    middle = error - 0.5 * (error.max() + error.min())
    crossings = time[1:][(middle[:-1] < 0.0) & (middle[1:] >= 0.0)]
    return float(np.diff(crossings).mean()) if len(crossings) > 1 else float("nan")
