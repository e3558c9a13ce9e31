"""Time stamps: how even they are, and how to bring signals onto an even grid."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .source_location import SourceLocation

EVENNESS = 1e-3
"""Largest deviation of one interval from the median, relative, at which a log still counts as uniform.

At 1 rad/s and 100 Hz it misplaces an angle by 1e-5 rad, less than one count of a 16-bit encoder (1e-4 rad).
"""
LONGEST_INTERVAL = 0.02
"""A longer interval [s] is a gap: what happened there is unknown."""
GAP_INTERVALS = (10.0, 100.0)
"""Bounds of that limit in median intervals, for slow and for fast logs."""
CROWDED = 0.25
"""A stamp nearer than this (median intervals) to the one before brings no news and makes splines swing."""


def is_uniform(time: FloatArray) -> bool:
    """Tell whether every interval is the median interval to within `EVENNESS`."""
    intervals = np.diff(time)
    median = np.median(intervals)
    return bool(np.abs(intervals - median).max() <= EVENNESS * median)


def sampling_rate(time: FloatArray) -> float:
    """Return the sampling rate [Hz].

    The mean rate of even stamps (exact even when they were printed with few digits); the median rate of
    uneven ones, which lost samples do not move.
    """
    if is_uniform(time):
        return float((len(time) - 1) / (time[-1] - time[0]))
    return float(1.0 / np.median(np.diff(time)))


def refuse_gaps(time: FloatArray, where: SourceLocation) -> None:
    """Refuse stamps [s] with an interval longer than 20 ms, a limit kept within 10 to 100 median intervals.

    Raises:
        ExoidError: Names the row after the first gap, the length of the gap and how many there are.
    """
    intervals = np.diff(time)
    shortest, longest = (count * np.median(intervals) for count in GAP_INTERVALS)
    limit = float(np.clip(LONGEST_INTERVAL, shortest, longest))
    gaps = np.flatnonzero(intervals > limit)
    if gaps.size:
        row = int(gaps[0]) + 1
        raise ExoidError(
            f"a gap of {intervals[row - 1]:.4g} s before this row (limit {limit:.4g} s; {gaps.size} in all)",
            where=where.row(row),
            remedy="split the log there and pass the pieces as several recordings",
        )


def uncrowded(time: FloatArray) -> slice | NDArray[np.bool_]:
    """Select the rows to interpolate from: all, or all but those stamped right after another.

    Stamps given on arrival come in bursts; a spline through two points almost above each other swings.

    Returns:
        An index for rows: ``slice(None)``, or a boolean mask (N,).
    """
    intervals = np.diff(time, prepend=-np.inf)
    crowded = intervals < CROWDED * np.median(intervals)
    return ~crowded if crowded.any() else slice(None)


def even_grid(time: FloatArray, rate: float) -> FloatArray:
    """Return even stamps [s] at ``rate`` [Hz] from ``time[0]`` up to at most ``time[-1]``."""
    steps = int(np.floor((time[-1] - time[0]) * rate * (1.0 + 1e-12)))
    grid: FloatArray = np.minimum(time[0] + np.arange(steps + 1) / rate, time[-1])
    return grid


def interpolate(time: FloatArray, values: FloatArray, grid: FloatArray, *, smooth: bool) -> FloatArray:
    """Bring columns from uneven onto even stamps.

    Args:
        time: Stamps [s], (N,), strictly increasing.
        values: Columns in any unit, (N, n).
        grid: Stamps asked for [s], (M,), within ``time``.
        smooth: True for angles and velocities, which inertia keeps smooth: a cubic spline, error O(dt⁴).
            False for accelerations and torques, which friction lets jump: a monotone cubic (PCHIP), which
            never leaves the range of its neighbours but errs by O(dt²) at turning points.

    Returns:
        Columns at ``grid``, (M, n).
    """
    curve = scipy.interpolate.CubicSpline(time, values) if smooth else scipy.interpolate.PchipInterpolator(time, values)
    columns: FloatArray = np.ascontiguousarray(curve(grid))
    return columns
