"""Zero-phase low-pass filter: a Butterworth filter forwards and backwards."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ComplexArray, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError

TOLERANCE = 1e-3
"""Relative error of an acceleration that the end of the record may cause; see `edge_length`."""

ORDER = 4
"""Order of one pass of the filters of motions and torques."""


def zero_phase(x: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """Low-pass columns forwards and backwards, without delay and with a gain of 1/√2 at ``cutoff``.

    A Butterworth filter of order 4 runs over the data twice, so the whole has order 8 and the gain
    |H|² = 1 / (1 + (Ω/Ω_d)^8), Ω = tan(π f / rate). For |H|² = 1/√2 at ``cutoff`` each pass is designed for the higher
    frequency f_d:

        tan(π f_d / rate) = tan(π cutoff / rate) / (√2 − 1)^(1/8).

    The record is extended beyond its ends by point reflection over `edge_length` samples. The filter is linear: an
    equation still holds after both of its sides are filtered.

    Args:
        x: Signals in any unit, (N, ...); filtered along the first axis.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz], below ``rate`` / 2.

    Returns:
        Filtered signals, of the shape of ``x``.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate, or the record is not longer than
            `edge_length` samples.
    """
    return both_passes(x, rate, cutoff, edge_length(rate, cutoff))


def slow_part(x: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """Low-pass of order 2 for checks, also of records that are shorter than what their ends distort."""
    if 0.32 * rate <= cutoff:  # hardly anything in the record is faster
        return x
    return both_passes(x, rate, cutoff, min(edge_length(rate, cutoff, 2), len(x) - 1), order=2)


def both_passes(
    x: FloatArray, rate: float, cutoff: float, pad: int, *, order: int = ORDER, weights: FloatArray | None = None
) -> FloatArray:
    """Filter forwards and backwards, with signals continued beyond both ends by ``pad`` samples."""
    # They are continued by point reflection, or by polynomials, of which weights (pad, window) give the samples before
    # the first one from a window of samples behind it.
    most = pad if weights is None else weights.shape[1] - 1
    if len(x) <= most:
        raise UnreadableInputError(
            f"{len(x)} samples ({len(x) / rate:.4g} s) are too few for a cut-off of {cutoff:.4g} Hz: "
            f"more than {most} ({most / rate:.4g} s) are needed",
            remedy="record longer or choose a higher cut-off",
        )
    sections = pass_sections(rate, cutoff, order).copy()  # SciPy wants to be able to write into it
    signals = x.reshape(len(x), -1).T
    out = np.empty(signals.shape)
    width = max(1, 2**19 // (8 * len(x)))  # signals of half a MB at once, which keeps temporaries small
    for start in range(0, len(signals), width):
        rows = slice(start, start + width)
        part = signals[rows]
        if weights is None:
            part = np.pad(part, ((0, 0), (pad, pad)), mode="reflect", reflect_type="odd")
        else:
            first, last = part[:, :1], part[:, -1:]  # relative to them, rounding errors of large angles do not grow
            before = first + (part[:, : most + 1] - first) @ weights.T
            after = last + (part[:, : -most - 2 : -1] - last) @ weights.T
            part = np.concatenate([before, part, after[:, ::-1]], axis=1)
        out[rows] = scipy.signal.sosfiltfilt(sections, part, padtype=None, padlen=0)[:, pad:-pad]
    return out.T.reshape(x.shape)


@lru_cache(maxsize=16)
def pass_sections(rate: float, cutoff: float, order: int = ORDER) -> FloatArray:
    """Second-order sections of one pass."""
    sections = scipy.signal.butter(order, design_frequency(rate, cutoff, order), fs=rate, output="sos")
    sections.flags.writeable = False
    return np.asarray(sections)


def edge_length(rate: float, cutoff: float, order: int = ORDER, tolerance: float = TOLERANCE) -> int:
    """Count the samples at each end of a record that `zero_phase` distorts."""
    # The point reflection beyond the end has the right value and slope, but curvature −ẍ instead of +ẍ. At m samples
    # from the end the relative error of the acceleration is 2·|Σ_{k>m} h_k|, with h the impulse response of both
    # passes. With the poles p_i of one pass, h_k = Σ c_i p_i^(k−1) for k ≥ 1, so
    #     2·|Σ_{k>m} h_k| ≤ 2·r^m·Σ |c_i / (1 − p_i)|,   r = max |p_i|.
    # The length is the m at which this bound falls to the tolerance.
    poles, weights, _ = zero_phase_modes(rate, cutoff, order)
    radius = float(np.abs(poles).max())
    if radius < 1e-9:  # all poles at the origin: the response is over after one sample
        return 1
    envelope = 2.0 * float(np.abs(weights / (1 - poles)).sum())
    return max(1, math.ceil(math.log(tolerance / envelope) / math.log(radius)))


@lru_cache(maxsize=16)
def zero_phase_modes(rate: float, cutoff: float, order: int = ORDER) -> tuple[ComplexArray, ComplexArray, float]:
    """Decompose the impulse response of `zero_phase` into decaying modes, h_k = Re Σ c_i p_i^(|k| − 1) for k ≠ 0."""
    # Modes are the poles of one pass. Of two that are conjugates of each other, one is left, with twice the weight.
    zeros, poles, gain = scipy.signal.butter(order, design_frequency(rate, cutoff, order), fs=rate, output="zpk")
    others = poles[:, np.newaxis] - poles + np.eye(len(poles))
    residues = gain * np.prod(poles[:, np.newaxis] - zeros, axis=1) / np.prod(others, axis=1)
    mirrored = gain * np.prod(1 - np.outer(poles, zeros), axis=1) / np.prod(1 - np.outer(poles, poles), axis=1)
    weights = residues * mirrored
    middle = 1.0 - 2.0 * float((weights / (1 - poles)).sum().real)  # a constant passes unchanged: Σ h_k = 1
    kept = poles.imag >= 0.0
    poles, weights = poles[kept], np.where(poles.imag > 0.0, 2.0, 1.0)[kept] * weights[kept]
    poles.flags.writeable = weights.flags.writeable = False
    return poles, weights, middle


@lru_cache(maxsize=16)
def noise_bandwidth(rate: float, cutoff: float) -> float:
    """Compute the fraction of white-noise power that `zero_phase` passes, 2/rate · ∫ |H|⁴ df up to rate/2."""
    midpoints = (np.arange(20_000, dtype=np.float64) + 0.5) * (0.5 * rate / 20_000)
    ratio = np.tan(math.pi * midpoints / rate) / math.tan(math.pi * design_frequency(rate, cutoff) / rate)
    with np.errstate(over="ignore"):  # the gain at half the rate is 0
        gain = 1.0 / (1.0 + ratio ** (2 * ORDER))  # |H|²
    return float(np.mean(gain**2))


def design_frequency(rate: float, cutoff: float, order: int = ORDER) -> float:
    """Compute the cut-off f_d of one pass for which both passes together have −3 dB at ``cutoff``."""
    if not 0.0 < cutoff < rate / 2.0:
        raise BadArgumentError(
            f"a cut-off of {cutoff:.4g} Hz is not below half the sampling rate of {rate:.4g} Hz",
            remedy=f"choose a cut-off between 0 and {0.4 * rate:.4g} Hz, or check that time is in seconds",
        )
    widened = math.tan(math.pi * cutoff / rate) / (math.sqrt(2.0) - 1.0) ** (0.5 / order)
    return rate / math.pi * math.atan(widened)
