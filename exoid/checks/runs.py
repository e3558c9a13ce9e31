"""Runs of equal samples in a signal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray


class Runs(NamedTuple):
    """Runs of consecutive samples with the same value, in order of time.

    Attributes:
        start: Index of the first sample of each run, (R,).
        length: Number of samples of each run, (R,).
        value: Value of each run, (R,).
    """

    start: NDArray[np.intp]
    length: NDArray[np.intp]
    value: FloatArray

    @classmethod
    def of(cls, x: FloatArray, tolerance: float = 0.0) -> Runs:
        """Find the runs of a signal.

        Args:
            x: The signal, (N,).
            tolerance: Largest change that counts as none.

        Returns:
            The runs; a sample without an equal neighbour is a run of one.
        """
        change = np.flatnonzero(np.abs(np.diff(x)) > tolerance) + 1
        start = np.concatenate([[0], change]).astype(np.intp)
        length = np.diff(np.concatenate([start, [len(x)]])).astype(np.intp)
        return cls(start, length, x[start])

    @property
    def stop(self) -> NDArray[np.intp]:
        """Index behind the last sample of each run, (R,)."""
        return self.start + self.length


def quantum(x: FloatArray) -> float:
    """Smallest step between different values of a signal; 0 for a constant one.

    Args:
        x: The signal, (N,).

    Returns:
        The step, in the unit of the signal.
    """
    values = np.unique(x)
    span = float(values[-1] - values[0])
    steps = np.diff(values)
    steps = steps[steps > 1e-9 * span]  # smaller ones are rounding
    return float(steps.min()) if len(steps) else 0.0


def median_of_five(x: FloatArray) -> FloatArray:
    """Median of each sample and two on each side, by comparisons of whole signals; the signal is zero beyond its ends.

    Args:
        x: The signal, (N,).

    Returns:
        The medians, (N,).
    """
    padded = np.pad(x, 2)
    a, b, c, d, e = (padded[k : k + len(x)] for k in range(5))
    lower = np.maximum(np.minimum(a, b), np.minimum(c, d))
    upper = np.minimum(np.maximum(a, b), np.maximum(c, d))
    return np.maximum(np.minimum(lower, upper), np.minimum(np.maximum(lower, upper), e))
