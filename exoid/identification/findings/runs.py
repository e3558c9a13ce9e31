"""Runs of equal samples in a signal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray


class Runs(NamedTuple):
    """Runs of consecutive samples with the same value, in order of time."""

    start: NDArray[np.intp]  # index of the first sample of each run, (R,)
    length: NDArray[np.intp]  # number of samples of each run, (R,)
    value: FloatArray  # value of each run, (R,)

    @classmethod
    def of(cls, x: FloatArray, tolerance: float = 0.0) -> Runs:
        """Find the runs of a signal."""
        change = np.flatnonzero(np.abs(np.diff(x)) > tolerance) + 1
        start = np.concatenate([[0], change]).astype(np.intp)
        length = np.diff(np.concatenate([start, [len(x)]])).astype(np.intp)
        return cls(start, length, x[start])

    @property
    def stop(self) -> NDArray[np.intp]:
        """Index behind the last sample of each run, (R,)."""
        return self.start + self.length


def quantum(x: FloatArray) -> float:
    """Smallest step between different values of a signal; 0 for a constant one."""
    values = np.unique(x)
    span = float(values[-1] - values[0])
    steps = np.diff(values)
    steps = steps[steps > 1e-9 * span]  # smaller ones are rounding
    return float(steps.min()) if len(steps) else 0.0


def median_of_five(x: FloatArray) -> FloatArray:
    """Median of each sample and two on each side; the signal is zero beyond its ends."""
    padded = np.pad(x, 2)
    a, b, c, d, e = (padded[k : k + len(x)] for k in range(5))
    lower = np.maximum(np.minimum(a, b), np.minimum(c, d))
    upper = np.minimum(np.maximum(a, b), np.maximum(c, d))
    return np.maximum(np.minimum(lower, upper), np.minimum(np.maximum(lower, upper), e))
