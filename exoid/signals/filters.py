"""Low-pass filters: without delay (forward and backward), and the causal one of doc. 2."""

from __future__ import annotations

import math

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError

BLOCK_BYTES = 2**19
"""Signals are filtered in blocks of about this size, but never less than one, so that temporaries stay small."""
TOLERANCE = 1e-3
"""Part of a sample's acceleration that the end of the record may spoil; see `edge_length`."""
ROUNDING = 1e-15
"""The same part where a record is cut into stretches: below what the filter's own rounding leaves."""


def zero_phase(x: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Low-pass columns forwards and backwards: no delay, and 1/√2 of the amplitude left at ``cutoff``.

    A Butterworth filter of order ``order`` runs over the data twice, so the whole has order 2·``order`` and
    the gain |H|² = 1 / (1 + (Ω/Ω_d)^(2·order)), Ω = tan(π f / rate). For |H|² = 1/√2 at ``cutoff`` each
    pass is designed for the higher frequency f_d:

        tan(π f_d / rate) = tan(π cutoff / rate) / (√2 − 1)^(1 / (2·order)).

    Beyond its ends the record is continued by point reflection over `edge_length` samples. The filter is
    linear: passed over both sides of an equation it keeps the equation true.

    Args:
        x: Signals in any unit, (N, ...); filtered along the first axis.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz], below ``rate`` / 2.
        order: Order of one pass.

    Returns:
        Filtered signals, of the shape of ``x``.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate, or the record is shorter than the
            stretch that its end spoils.
    """
    sections = scipy.signal.butter(order, _design_frequency(rate, cutoff, order), fs=rate, output="sos")
    pad = edge_length(rate, cutoff, order)
    if len(x) <= pad:
        raise ExoidError(
            f"{len(x)} samples ({len(x) / rate:.4g} s) are too few for a cut-off of {cutoff:.4g} Hz: "
            f"more than {pad} ({pad / rate:.4g} s) are needed",
            remedy="record longer or choose a higher cut-off",
        )
    signals = x.reshape(len(x), -1).T
    out = np.empty(signals.shape)
    width = max(1, BLOCK_BYTES // (8 * len(x)))
    for first in range(0, len(signals), width):
        rows = slice(first, first + width)
        out[rows] = scipy.signal.sosfiltfilt(sections, signals[rows], padlen=pad)
    return out.T.reshape(x.shape)


def edge_length(rate: float, cutoff: float, order: int = 4, tolerance: float = TOLERANCE) -> int:
    """Return how many samples at each end of a record `zero_phase` spoils.

    Beyond the end the filter sees a point reflection, which has the right value and slope but curvature
    −ẍ for +ẍ: m samples inside, a share 2·|Σ_{k>m} h_k| of the acceleration is missing, h the impulse
    response of both passes. With the poles p_i of one pass, h_k = Σ c_i p_i^(k−1) for k ≥ 1, so

        2·|Σ_{k>m} h_k| ≤ 2·r^m·Σ |c_i / (1 − p_i)|,   r = max |p_i|.

    The length is where this envelope falls to ``tolerance``.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.
        tolerance: Share of the acceleration that may be missing.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    zeros, poles, gain = scipy.signal.butter(order, _design_frequency(rate, cutoff, order), fs=rate, output="zpk")
    radius = float(np.abs(poles).max())
    if radius < 1e-9:  # all poles at the origin: the response is over after one sample
        return 1
    others = poles[:, np.newaxis] - poles + np.eye(len(poles))
    residues = gain * np.prod(poles[:, np.newaxis] - zeros, axis=1) / np.prod(others, axis=1)
    mirrored = gain * np.prod(1 - np.outer(poles, zeros), axis=1) / np.prod(1 - np.outer(poles, poles), axis=1)
    envelope = 2.0 * float(np.abs(residues * mirrored / (1 - poles)).sum())
    return max(1, math.ceil(math.log(tolerance / envelope) / math.log(radius)))


def reach(rate: float, cutoff: float, order: int = 4) -> int:
    """Return how many samples away a sample still matters, beyond rounding, to one that `zero_phase` filtered.

    A stretch of a record, filtered with so many more samples at both sides, comes out as in the whole.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.
    """
    return edge_length(rate, cutoff, order, ROUNDING)


def noise_bandwidth(rate: float, cutoff: float, order: int = 4) -> float:
    """Return the share of white noise power that `zero_phase` lets through, 2/rate · ∫ |H|⁴ df up to rate/2.

    Of N filtered samples only this share carries independent noise.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.
    """
    midpoints = (np.arange(20_000, dtype=np.float64) + 0.5) * (0.5 * rate / 20_000)
    return float(np.mean(zero_phase_gain(midpoints, rate, cutoff, order) ** 2))


def zero_phase_gain(frequency: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Return what `zero_phase` leaves of an amplitude, |H|² = 1 / (1 + (Ω/Ω_d)^(2·order)).

    Args:
        frequency: From 0 to half the rate [Hz], any shape.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    ratio = np.tan(math.pi * frequency / rate) / math.tan(math.pi * _design_frequency(rate, cutoff, order) / rate)
    with np.errstate(over="ignore"):  # at half the rate nothing is left
        return np.asarray(1.0 / (1.0 + ratio ** (2 * order)))


def exponential_moving_average(x: FloatArray, alpha: float) -> FloatArray:
    """Smooth columns as doc. 2, sec. III does: y_k = α x_k + (1 − α) y_{k−1}, started at y_0 = x_0.

    Causal: a ramp comes out (1 − α)/α samples late.

    Args:
        x: Signals in any unit, (N, ...); filtered along the first axis.
        alpha: Weight of the newest sample, 0 < α ≤ 1; 1 leaves ``x`` as it is.

    Returns:
        Smoothed signals, of the shape of ``x``.

    Raises:
        ExoidError: α is outside (0, 1].
    """
    if not 0.0 < alpha <= 1.0:
        raise ExoidError(f"alpha is {alpha}", remedy="pass 0 < alpha ≤ 1, the weight of the newest sample")
    smoothed, _ = scipy.signal.lfilter([alpha], [1.0, alpha - 1.0], x, axis=0, zi=(1.0 - alpha) * x[:1])
    return np.asarray(smoothed, dtype=np.float64)


def _design_frequency(rate: float, cutoff: float, order: int) -> float:
    """Return f_d [Hz], where one pass has −3 dB so that both together have it at ``cutoff``."""
    if order < 1 or order != int(order):
        raise ExoidError(f"filter order is {order}", remedy="pass a whole number from 1; 4 is usual")
    if not 0.0 < cutoff < rate / 2.0:
        raise ExoidError(
            f"a cut-off of {cutoff:.4g} Hz is not below half the sampling rate of {rate:.4g} Hz",
            remedy=f"choose a cut-off between 0 and {0.4 * rate:.4g} Hz, or check that time is in seconds",
        )
    widened = math.tan(math.pi * cutoff / rate) / (math.sqrt(2.0) - 1.0) ** (0.5 / order)
    return rate / math.pi * math.atan(widened)
