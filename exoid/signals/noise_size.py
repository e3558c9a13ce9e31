"""Size of noise that outliers and the signal itself hardly change."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

GAIN = 70.0
"""Variance of the fourth differences of white noise of variance one, 1² + 4² + 6² + 4² + 1²."""


def robust_std(x: FloatArray) -> FloatArray:
    """Standard deviation about zero by the median of the absolute values, 1.4826 med |x|."""
    return np.asarray(1.4826 * np.median(np.abs(x), axis=0))


def white_noise(signals: FloatArray) -> FloatArray:
    """Standard deviation of white noise in smooth signals, by their fourth differences."""
    return np.asarray(robust_std(np.diff(signals, 4, axis=0)) / np.sqrt(GAIN))
