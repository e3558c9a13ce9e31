"""Time stamps: uniformity, gaps, and what is selected, averaged and interpolated with them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray
from exoid.errors import UnreadableInputError

from .source import ARRAY, SourceLocation

if TYPE_CHECKING:
    from typing_extensions import Self

EVENNESS = 1e-3
"""Largest relative deviation of an interval from the median of a uniform log.

At 1 rad/s and 100 Hz it changes an angle by 1e-5 rad, less than one count of a 16-bit encoder (1e-4 rad).
"""

NEAR_GAP = 0.5
"""Time before and behind a gap in which rows do not count [s]."""


def is_uniform(time: FloatArray) -> bool:
    """Tell whether every interval is within `EVENNESS` of the median interval."""
    intervals = np.diff(time)
    median = np.median(intervals)
    return bool(np.abs(intervals - median).max() <= EVENNESS * median)


def sampling_rate(time: FloatArray) -> float:
    """Compute the sampling rate."""
    # For uniform stamps it is the mean rate, which is exact even if they are printed with few digits. It has
    # twelve digits: more would be rounding, by which parts of a recording differ. For uneven stamps it is the
    # median rate, which lost samples do not change.
    if is_uniform(time):
        return float(f"{(len(time) - 1) / (time[-1] - time[0]):.12g}")
    return float(1.0 / np.median(np.diff(time)))


def _longest_interval(intervals: FloatArray) -> float:
    """Interval beyond which it is a gap [s]: 20 ms, or 10 to 100 median intervals."""
    return float(np.clip(0.02, 10.0 * np.median(intervals), 100.0 * np.median(intervals)))


def refuse_gaps(time: FloatArray, where: SourceLocation = ARRAY) -> None:
    """Refuse time stamps with a gap."""
    intervals = np.diff(time)
    limit = _longest_interval(intervals)
    gaps = np.flatnonzero(intervals > limit)
    if gaps.size:
        row = int(gaps[0]) + 1
        raise UnreadableInputError(
            f"a gap of {intervals[row - 1]:.4g} s before this row (limit {limit:.4g} s; {gaps.size} in all)",
            **where.evidence(row),
            remedy='pass gaps="split", or split the log there and pass the parts as several recordings',
            command="give --gaps split, or split the log there and name the parts",
        )


def split_at_gaps(table: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Fill gaps in rows whose first column is time; rows in gaps and near them do not count."""
    # A grid without gaps is what filters need. They spread what is made up by `NEAR_GAP` at most, if cut-offs are 4 Hz
    # or more: two periods.
    time = table[:, 0]
    intervals = np.diff(time)
    step, gaps = float(np.median(intervals)), np.flatnonzero(intervals > _longest_interval(intervals))
    if not gaps.size:
        return table, np.ones(len(time), dtype=np.bool_)
    if intervals[gaps].sum() > 10.0 * (time[-1] - time[0] - intervals[gaps].sum()):
        raise UnreadableInputError(
            f"gaps of {intervals[gaps].sum():.4g} s in a log of {time[-1] - time[0]:.4g} s",
            remedy="check the unit of time; pass parts that belong to different days as several recordings",
        )
    made_up = [np.linspace(time[k], time[k + 1], round(intervals[k] / step) + 1)[1:-1] for k in gaps]
    grid = np.insert(time, np.repeat(gaps + 1, [len(part) for part in made_up]), np.concatenate(made_up))
    filled = np.column_stack([grid, interpolate(time, table[:, 1:], grid, smooth=False)])
    counted = np.ones(len(grid), dtype=np.bool_)
    for k in gaps:
        counted[(grid > time[k] - NEAR_GAP) & (grid < time[k + 1] + NEAR_GAP)] = False
    return filled, counted


def even_grid(time: FloatArray, rate: float) -> FloatArray:
    """Make uniform time stamps within the range of others."""
    steps = int(np.floor((time[-1] - time[0]) * rate * (1.0 + 1e-12)))
    return np.asarray(np.minimum(time[0] + np.arange(steps + 1) / rate, time[-1]))


def interpolate(time: FloatArray, values: FloatArray, grid: FloatArray, *, smooth: bool) -> FloatArray:
    """Interpolate columns at other time stamps; those that were not measured stay NaN."""
    out = np.full((len(grid), values.shape[1]), np.nan)
    there = ~np.isnan(values[0])  # a column is NaN throughout or nowhere
    values = values[:, there]
    curve = scipy.interpolate.CubicSpline(time, values) if smooth else scipy.interpolate.PchipInterpolator(time, values)
    out[:, there] = curve(grid)
    return out


def interpolate_mask(time: FloatArray, mask: BoolArray, grid: FloatArray) -> BoolArray:
    """Carry a mask over to other time stamps: a sample counts if both of its neighbours do."""
    return np.asarray(np.interp(grid, time, mask.astype(np.float64)) > 1.0 - EVENNESS)


class Sampled(ABC):
    """Measurements at the samples of a recording, which select and resample themselves."""

    @abstractmethod
    def rows(self, rows: slice | BoolArray) -> Self:
        """Select samples."""

    @abstractmethod
    def _changed(self, change: Callable[[FloatArray, bool], FloatArray]) -> Self:
        """Change columns at all samples, by a linear function that also takes whether they are smooth."""

    def interpolated(self, time: FloatArray, grid: FloatArray, rows: slice | BoolArray = slice(None)) -> Self:
        """Interpolate at other time stamps: smooth columns by cubic splines, others by monotone cubics (PCHIP)."""
        return self._changed(lambda x, smooth: interpolate(time, x[rows], grid, smooth=smooth))

    def averaged(self, size: int) -> Self:
        """Average neighbouring samples; those that do not fill a group are left out."""
        return self._changed(lambda x, _: x[: len(x) // size * size].reshape(-1, size, x.shape[1]).mean(axis=1))
