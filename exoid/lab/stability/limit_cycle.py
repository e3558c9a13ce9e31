"""Limit cycles: amplitude and period of oscillations, and whether they last."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.tracking import Tracking
from exoid.errors import BadArgumentError


class LimitCycle(NamedTuple):
    """Oscillation of the error of each joint in the last part of a run."""

    peak_to_peak: FloatArray  # peak-to-peak amplitude [rad], (n,)
    period: FloatArray  # mean time between upward crossings of the middle [s], (n,); NaN with fewer than two crossings
    lasting: FloatArray  # whether the oscillation of each joint does not decay, (n,)

    @property
    def peak_to_peak_deg(self) -> FloatArray:
        """Peak-to-peak amplitude [deg], (n,)."""
        return np.asarray(np.rad2deg(self.peak_to_peak))

    @property
    def exists(self) -> bool:
        """Whether the oscillation of any joint lasts."""
        return bool(self.lasting.any())


def find_limit_cycle(run: Tracking, last: float = 0.5) -> LimitCycle:
    """Find oscillations in the last part of a run towards a constant target, or along a periodic one.

    Args:
        run: The run.
        last: Share of the run to search, at its end; it should contain two periods of the oscillation.

    Returns:
        Amplitude and period of each joint.

    Raises:
        ExoidError: The share is not between 0 and 1, or leaves too few samples.
    """
    if not 0.0 < last <= 1.0:
        raise BadArgumentError(f"the last {last:g} of a run", remedy="give a share between 0 and 1")
    begin = int((1.0 - last) * len(run.time))
    time, error = run.time[begin:], run.error[begin:]
    if len(time) < 8:
        raise BadArgumentError(
            f"{len(time)} samples are too few for an oscillation", remedy="run longer, or log more often"
        )
    early, late = (np.ptp(half, axis=0) for half in np.array_split(error, 2))
    # Peak-to-peak amplitude below which a joint counts as at rest [rad].
    # Smallest ratio of the second half of an oscillation to the first for which it lasts.
    lasting = (late > np.deg2rad(0.05)) & (late >= 0.9 * early)
    periods = np.array([_period(time, column) for column in error.T])
    return LimitCycle(np.ptp(error, axis=0), periods, lasting)


def _period(time: FloatArray, error: FloatArray) -> float:
    middle = error - 0.5 * (error.max() + error.min())
    crossings = time[1:][(middle[:-1] < 0.0) & (middle[1:] >= 0.0)]
    return float(np.diff(crossings).mean()) if len(crossings) > 1 else float("nan")
