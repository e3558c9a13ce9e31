"""Smooth motions and their derivatives: a low-pass that keeps what happens at the ends, and finite differences."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError

from .filters.low_pass import TOLERANCE, both_passes, edge_length

Accuracy = Literal[2, 4]


STENCILS: dict[tuple[Literal[1, 2], Accuracy], tuple[FloatArray, FloatArray]] = {
    (1, 2): (np.array([-1, 0, 1]) / 2, np.array([[-3, 4, -1]]) / 2),
    (1, 4): (np.array([1, -8, 0, 8, -1]) / 12, np.array([[-25, 48, -36, 16, -3], [-3, -10, 18, -6, 1]]) / 12),
    (2, 2): (np.array([1.0, -2.0, 1.0]), np.array([[2.0, -5.0, 4.0, -1.0]])),
    (2, 4): (
        np.array([-1, 16, -30, 16, -1]) / 12,
        np.array([[45, -154, 214, -156, 61, -10], [10, -15, -4, 14, -6, 1]]) / 12,
    ),
}
"""Weights for the first and the second derivative, with an error of O(dt²) or O(dt⁴): of a sample and its m neighbours
on each side, (2 m + 1,), and of the first w samples, one-sided, for the derivative at the first m of them, (m, w)."""


class Kinematics(NamedTuple):
    """Angles, velocities and accelerations of a recording.

    Attributes:
        q: Angles [rad], (N, n).
        v: Velocities [rad/s], (N, n).
        a: Accelerations [rad/s²], (N, n).
        valid: Rows that are not affected by the ends of the record.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    valid: slice

    def __repr__(self) -> str:
        samples, joints = self.q.shape
        return f"Kinematics({samples} samples, {joints} joints, valid: {self.valid.start} to {self.valid.stop})"


def smooth_motion(x: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """Low-pass angles, velocities or accelerations as `zero_phase`, with a continuation that keeps their curvature."""
    # At each end, the motion is continued by the polynomial of degree 7 that fits the last two periods of the cut-off
    # best. The filter passes polynomials of this degree unchanged, so that only what they do not fit is distorted. Rows
    # less than `motion_edge` from an end should not be used.
    pad = edge_length(rate, cutoff, tolerance=1e-8)
    window = max(12, round(2.0 * rate / cutoff))
    return both_passes(x, rate, cutoff, pad, weights=_continuation(window, pad))


def motion_edge(rate: float, cutoff: float) -> int:
    """Count the samples at each end of a record that are not used after `smooth_motion`.

    This is one period of the cut-off f_k, and at least six samples. Bound of the error that the end causes beyond them
    in the acceleration of a sine of frequency f, as part of its amplitude:

    * 1e-5 for f ≤ f_k/8,
    * 2e-4 for f ≤ f_k/4, half of the cut-off of the parallel filter by default,
    * 1e-2 for f ≤ f_k/2, where the filter itself attenuates by 2e-3.

    Noise of the angle causes at most 1.5 times as much noise of the acceleration as far from the end. Faster motions
    have no bound. Filters ring longer at rates below 4 f_k: more samples count there.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].

    Returns:
        Number of samples at each end.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    if rate < 4.0 * cutoff:
        return edge_length(rate, cutoff, tolerance=TOLERANCE if rate > 3.0 * cutoff else 1e-6)
    return max(6, math.ceil(rate / cutoff))


@lru_cache(maxsize=16)
def _continuation(window: int, length: int) -> FloatArray:
    """Weights that continue ``window`` samples by ``length`` samples before them: least-squares polynomials."""
    inside = 2.0 * np.arange(window) / (window - 1) - 1.0
    before = 2.0 * np.arange(-length, 0) / (window - 1) - 1.0
    # Degree 7, which the filter itself passes unchanged
    fit = np.linalg.pinv(np.polynomial.legendre.legvander(inside, 7))
    weights: FloatArray = np.polynomial.legendre.legvander(before, 7) @ fit
    weights.flags.writeable = False
    return weights


def difference(x: FloatArray, rate: float, order: Literal[1, 2], accuracy: Accuracy = 2) -> FloatArray:
    """Compute the first or second derivative by central differences (doc. 1, sec. III-B), one-sided at the ends."""
    # On a sine of ω the relative error of the first derivative is (ω dt)²/6, or (ω dt)⁴/30 over five points; that of
    # the second is (ω dt)²/12, or (ω dt)⁴/90. The weights at the far end are those of the near end reversed.
    (centre, ends), samples = STENCILS[order, accuracy], len(x)
    margin, width = ends.shape
    if samples < max(width, 2 * margin + 1):
        raise UnreadableInputError(
            f"{samples} samples are too few for a difference over {width}", remedy="record longer"
        )
    signals = x.reshape(samples, -1).T
    out = np.empty(signals.shape)
    parity = 1.0 if order == 2 else -1.0
    for signal, derived in zip(signals, out, strict=True):
        derived[margin : samples - margin] = np.correlate(signal, centre, "valid")
        derived[:margin] = ends @ signal[:width]
        derived[samples - margin :] = parity * (ends @ signal[: -width - 1 : -1])[::-1]
    return np.asarray(rate**order * out.T.reshape(x.shape))
