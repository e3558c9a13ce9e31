"""Causal low-pass without phase error: symmetric kernels, whose only effect beside smoothing is a known delay.

The zero-phase filter of an identification needs samples that are still to come. A symmetric kernel of 2 d + 1 samples
gives the same, d samples late. All channels pass the same kernel, so that they stay together. The kernel is Gaussian,
which neither rings nor is wider than it must be, and its derivatives give velocity and acceleration: with H(f) the gain
of the kernel, the three have the gains H, 2πi f H and (2πi f)² H.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

WIDTH = 4.0
"""Half the length of a kernel over its standard deviation."""

NARROWEST = 1.2
"""Smallest standard deviation in samples for which the derivatives of the kernel are accurate to 1 %."""


class Kernels(NamedTuple):
    """Weights of a sample and its d neighbours on each side, (2 d + 1,) each, to be summed with the samples."""

    smooth: FloatArray  # weights of the smoothed signal
    first: FloatArray  # weights of its first derivative [1/s]
    second: FloatArray  # weights of its second derivative [1/s²]

    @property
    def delay(self) -> int:
        """Delay d in samples."""
        return len(self.smooth) // 2


def gaussian(rate: float, cutoff: float) -> Kernels:
    """Make a Gaussian kernel with a gain of 1/√2 at the cut-off, σ = √(ln 2) / (2π f_c)."""
    # A constant passes unchanged. The derivatives of straight lines and parabolas are exact.
    sigma = math.sqrt(math.log(2.0)) / (2.0 * math.pi * cutoff)
    if not NARROWEST <= sigma * rate < 1e5:
        raise ExoidError(
            f"a causal low-pass of {cutoff:.4g} Hz at {rate:.4g} samples a second",
            remedy=f"choose a cut-off below {math.sqrt(math.log(2.0)) * rate / (2.0 * math.pi * NARROWEST):.3g} Hz, "
            "and the rate in Hz",
        )
    half = math.ceil(WIDTH * sigma * rate)
    t = np.arange(-half, half + 1) / rate
    smooth = np.exp(-0.5 * (t / sigma) ** 2)
    smooth /= smooth.sum()
    first = t * smooth
    second = (t**2 - smooth @ t**2) * smooth
    return Kernels(smooth, first / (first @ t), second / (0.5 * second @ t**2))


def sliding(weights: FloatArray, rows: range) -> FloatArray:
    """Matrix that applies weights to the samples behind a history of as many samples less one."""
    matrix = np.zeros((len(rows), len(weights) - 1 + rows.stop))
    for k, row in enumerate(rows):
        matrix[k, row : row + len(weights)] = weights
    return matrix
