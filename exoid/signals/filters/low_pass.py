"""Zero-phase low-pass filter: a Butterworth filter forwards and backwards, and the same at the requested rows only."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import ComplexArray, FloatArray
from exoid.errors import ExoidError

BLOCK_BYTES = 2**19
"""Signals are filtered in blocks of about this size, of one signal at least, which keeps temporaries small."""

TOLERANCE = 1e-3
"""Relative error of an acceleration that the end of the record may cause; see `edge_length`."""

ROUNDING = 1e-15
"""The same error where a record is filtered in segments: below the rounding error of the filter."""

REFLECTION: dict[str, Any] = {"mode": "reflect", "reflect_type": "odd"}
"""Arguments of `numpy.pad` that reflect a signal about its end points."""

OVERSAMPLING = 4.0
"""Rows per row of independent noise, so that products of two filtered signals do not alias onto frequency zero."""

BLOCK = 128
"""Samples of a block of the parallel filter, about."""

DECAYED = 1e-20
"""Part of a state that has decayed."""


def zero_phase(x: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Low-pass columns forwards and backwards, without delay and with a gain of 1/√2 at ``cutoff``.

    A Butterworth filter of order ``order`` runs over the data twice, so the whole has order 2·``order`` and
    the gain |H|² = 1 / (1 + (Ω/Ω_d)^(2·order)), Ω = tan(π f / rate). For |H|² = 1/√2 at ``cutoff`` each
    pass is designed for the higher frequency f_d:

        tan(π f_d / rate) = tan(π cutoff / rate) / (√2 − 1)^(1 / (2·order)).

    The record is extended beyond its ends by point reflection over `edge_length` samples. The filter is linear: an
    equation still holds after both of its sides are filtered.

    Args:
        x: Signals in any unit, (N, ...); filtered along the first axis.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz], below ``rate`` / 2.
        order: Order of one pass.

    Returns:
        Filtered signals, of the shape of ``x``.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate, or the record is not longer than
            `edge_length` samples.
    """
    pad = edge_length(rate, cutoff, order)
    refuse_short(x, rate, cutoff, pad)
    return both_passes(x, rate, cutoff, order, pad, partial(np.pad, pad_width=((0, 0), (pad, pad)), **REFLECTION))


def refuse_short(x: FloatArray, rate: float, cutoff: float, most: int) -> None:
    """Refuse a record of no more than so many samples.

    Args:
        x: Signals, (N, ...).
        rate: Sampling rate [Hz].
        cutoff: Cut-off [Hz].
        most: Number of samples that is too small.

    Raises:
        ExoidError: It is too short.
    """
    if len(x) <= most:
        raise ExoidError(
            f"{len(x)} samples ({len(x) / rate:.4g} s) are too few for a cut-off of {cutoff:.4g} Hz: "
            f"more than {most} ({most / rate:.4g} s) are needed",
            remedy="record longer or choose a higher cut-off",
        )


def both_passes(
    x: FloatArray, rate: float, cutoff: float, order: int, pad: int, extend: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Filter forwards and backwards.

    Args:
        x: Signals, (N, ...).
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.
        pad: Number of samples by which signals are continued.
        extend: Function that continues signals (K, N) beyond both ends.

    Returns:
        Filtered signals, of the shape of ``x``.
    """
    sections = _sections(rate, cutoff, order).copy()  # SciPy wants to be able to write into it
    signals = x.reshape(len(x), -1).T
    out = np.empty(signals.shape)
    width = max(1, BLOCK_BYTES // (8 * len(x)))
    for first in range(0, len(signals), width):
        rows = slice(first, first + width)
        filtered = scipy.signal.sosfiltfilt(sections, extend(signals[rows]), padtype=None, padlen=0)
        out[rows] = filtered[:, pad:-pad]
    return out.T.reshape(x.shape)


@lru_cache(maxsize=16)
def _sections(rate: float, cutoff: float, order: int) -> FloatArray:
    """Second-order sections of one pass."""
    sections = scipy.signal.butter(order, design_frequency(rate, cutoff, order), fs=rate, output="sos")
    sections.flags.writeable = False
    return np.asarray(sections)


def edge_length(rate: float, cutoff: float, order: int = 4, tolerance: float = TOLERANCE) -> int:
    """Count the samples at each end of a record that `zero_phase` distorts.

    The point reflection beyond the end has the right value and slope, but curvature −ẍ instead of +ẍ. At m samples from
    the end the relative error of the acceleration is 2·|Σ_{k>m} h_k|, with h the impulse response of both passes. With
    the poles p_i of one pass, h_k = Σ c_i p_i^(k−1) for k ≥ 1, so

        2·|Σ_{k>m} h_k| ≤ 2·r^m·Σ |c_i / (1 − p_i)|,   r = max |p_i|.

    The length is the m at which this bound falls to ``tolerance``.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.
        tolerance: Relative error of the acceleration that is allowed.

    Returns:
        Number of samples at each end.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    poles, weights, _ = zero_phase_modes(rate, cutoff, order)
    radius = float(np.abs(poles).max())
    if radius < 1e-9:  # all poles at the origin: the response is over after one sample
        return 1
    envelope = 2.0 * float(np.abs(weights / (1 - poles)).sum())
    return max(1, math.ceil(math.log(tolerance / envelope) / math.log(radius)))


@lru_cache(maxsize=16)
def zero_phase_modes(rate: float, cutoff: float, order: int = 4) -> tuple[ComplexArray, ComplexArray, float]:
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


def reach(rate: float, cutoff: float, order: int = 4) -> int:
    """Count the samples to each side that affect a sample that `zero_phase` filters, beyond rounding.

    A segment of a record, filtered with this many samples more at both sides, is the same as in the whole record.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.

    Returns:
        Number of samples to each side.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    return edge_length(rate, cutoff, order, ROUNDING)


@lru_cache(maxsize=16)
def noise_bandwidth(rate: float, cutoff: float, order: int = 4) -> float:
    """Compute the fraction of white-noise power that `zero_phase` passes, 2/rate · ∫ |H|⁴ df up to rate/2.

    Only this fraction of the filtered samples carries independent noise.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.

    Returns:
        Noise bandwidth over half the rate, between 0 and 1.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    midpoints = (np.arange(20_000, dtype=np.float64) + 0.5) * (0.5 * rate / 20_000)
    return float(np.mean(zero_phase_gain(midpoints, rate, cutoff, order) ** 2))


def zero_phase_gain(frequency: FloatArray, rate: float, cutoff: float, order: int = 4) -> FloatArray:
    """Compute the gain of `zero_phase`, |H|² = 1 / (1 + (Ω/Ω_d)^(2·order)).

    Args:
        frequency: Frequencies from 0 to half the rate [Hz], any shape.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.

    Returns:
        Gain at each frequency.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
    ratio = np.tan(math.pi * frequency / rate) / math.tan(math.pi * design_frequency(rate, cutoff, order) / rate)
    with np.errstate(over="ignore"):  # the gain at half the rate is 0
        return np.asarray(1.0 / (1.0 + ratio ** (2 * order)))


def design_frequency(rate: float, cutoff: float, order: int) -> float:
    """Compute the cut-off f_d of one pass for which both passes together have −3 dB at ``cutoff``.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.

    Returns:
        Cut-off frequency of one pass [Hz].

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate, or the order is below 1.
    """
    if order < 1 or order != int(order):
        raise ExoidError(f"filter order is {order}", remedy="pass a whole number from 1; 4 is usual")
    if not 0.0 < cutoff < rate / 2.0:
        raise ExoidError(
            f"a cut-off of {cutoff:.4g} Hz is not below half the sampling rate of {rate:.4g} Hz",
            remedy=f"choose a cut-off between 0 and {0.4 * rate:.4g} Hz, or check that time is in seconds",
        )
    widened = math.tan(math.pi * cutoff / rate) / (math.sqrt(2.0) - 1.0) ** (0.5 / order)
    return rate / math.pi * math.atan(widened)


@dataclass(frozen=True)
class ParallelFilter:
    """Zero-phase Butterworth filter, as :func:`exoid.signals.zero_phase`, worked out at the requested rows only.

    Filtered rows are redundant: of 500 a second, filtered at 8 Hz, sixteen carry independent noise. Sums of squares and
    products over every :attr:`stride`-th row equal those over all rows, so only these are computed. The filter is
    linear and the same for all rows, so τ = W β still holds after both sides are filtered.

    Attributes:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency [Hz].
        order: Order of one of the two passes.
    """

    rate: float
    cutoff: float
    order: int

    @cached_property
    def reach(self) -> int:
        """Number of samples to each side that affect a filtered sample, beyond rounding."""
        return reach(self.rate, self.cutoff, self.order)

    @cached_property
    def independent_fraction(self) -> float:
        """Fraction of the filtered samples that carries independent noise."""
        return noise_bandwidth(self.rate, self.cutoff, self.order)

    @property
    def stride(self) -> int:
        """Decimation factor that loses no information."""
        return max(1, int(1.0 / (OVERSAMPLING * self.independent_fraction)))

    def __call__(self, signals: FloatArray, rows: range) -> FloatArray:
        """Filter signals and decimate them to the requested rows.

        The signals are extended beyond their ends by point reflection.

        Args:
            signals: Signals in any unit, (K, N).
            rows: Requested samples, evenly spaced, R of them.

        Returns:
            Filtered signals at these samples, (K, R).
        """
        first, last = rows[0] - self.reach, rows[-1] + 1 + self.reach
        beyond = max(0, -first), max(0, last - signals.shape[1])
        window = signals[:, max(0, first) : last]
        if any(beyond):
            window = np.pad(window, ((0, 0), beyond), **REFLECTION)
        return self.among_zeros(window, range(self.reach, self.reach + len(rows) * rows.step, rows.step))

    def among_zeros(
        self, signals: Sequence[FloatArray] | FloatArray, rows: range, counted: NDArray[np.bool_] | None = None
    ) -> FloatArray:
        """Filter signals that are zero before and after, as samples that do not count are.

        Args:
            signals: Signals in any unit, K of (N,).
            rows: Requested samples, evenly spaced, R of them.
            counted: Mask of samples that count: others are taken for zero, (N,). None for all.

        Returns:
            Filtered signals at these samples, (K, R).
        """
        blocks = _blocks(self, rows.step)
        begin, end = max(0, rows[0] - self.reach), min(len(signals[0]), rows[-1] + 1 + self.reach)
        lead = -(-(rows[0] - begin) // blocks.size)  # the first row begins a block
        wanted, behind = -(-len(rows) * rows.step // blocks.size), -(-(end - rows[0]) // blocks.size)
        padded = np.zeros((lead + max(wanted, behind), blocks.size))
        place = lead * blocks.size - rows[0]
        window = padded.reshape(-1)[place + begin : place + end]
        left_out = None if counted is None or counted[begin:end].all() else ~counted[begin:end]
        products = np.empty((len(padded), len(signals), blocks.products.shape[1]))
        for k, signal in enumerate(signals):  # one after the other, in the processor's cache
            window[:] = signal[begin:end]
            if left_out is not None:
                window[left_out] = 0.0
            np.matmul(padded, blocks.products, out=products[:, k])
        filtered = blocks.joined(products)[lead : lead + wanted]
        return np.asarray(filtered.transpose(1, 0, 2).reshape(len(signals), -1)[:, : len(rows)])


class _Blocks(NamedTuple):
    """The filter for blocks of B samples, at every step-th of them."""

    # The impulse response is a sum of decaying modes, h_k = Re Σ c_i p_i^(|k| − 1) for k ≠ 0. What samples far from a
    # block add to its rows is therefore said by one complex number a mode and side, Σ x_j p_i^j, the *states*.

    # what samples of a block add to its own rows, and to the states of the blocks after and before it, (B, M +
    # 4 m) with M rows a block, m modes, and real and imaginary parts one after the other
    products: FloatArray
    states: FloatArray  # what states add to the rows of a block, (4 m, M)
    decay: ComplexArray  # factor of a state from block to block, (m,)

    @property
    def size(self) -> int:
        """Samples of a block."""
        return len(self.products)

    def joined(self, products: FloatArray) -> FloatArray:
        """Add what comes from other blocks."""
        rows, modes = self.states.shape[1], len(self.decay)
        own = np.ascontiguousarray(products[..., rows:]).view(np.complex128)
        states = np.zeros_like(own)
        for mode, decay in enumerate(self.decay):
            states[1:, :, mode] = _decaying_sum(own[:-1, :, mode].copy(), decay)
            states[:-1, :, modes + mode] = _decaying_sum(own[:0:-1, :, modes + mode].copy(), decay)[::-1]
        return np.asarray(products[..., :rows] + states.view(np.float64) @ self.states)


def _decaying_sum(x: ComplexArray, decay: complex) -> ComplexArray:
    """Σ_j decay^(k−j) x_j over j ≤ k for each k, along the first axis, in place: over 2, 4, 8, … terms."""
    distance = 1
    while distance < len(x) and abs(decay) > DECAYED:
        x[distance:] += decay * x[:-distance]
        decay, distance = decay * decay, 2 * distance
    return x


@lru_cache(maxsize=16)
def _blocks(filter_: ParallelFilter, step: int) -> _Blocks:
    """Matrices of a filter for every ``step``-th row."""
    poles, weights, middle = zero_phase_modes(filter_.rate, filter_.cutoff, filter_.order)
    rows = step * np.arange(max(1, round(BLOCK / step)))
    size = len(rows) * step
    k = np.arange(size)
    response = np.append(middle, (poles ** k[:-1, np.newaxis] @ weights).real)
    own = response[np.abs(k[:, np.newaxis] - rows)]
    to_after, to_before = poles ** k[::-1, np.newaxis], poles ** k[:, np.newaxis]
    from_before, from_after = (weights * poles ** power[:, np.newaxis] for power in (rows, size - 1 - rows))
    parts = np.hstack([to_after, to_before]).view(np.float64)
    both = np.hstack([from_before, from_after])
    states = np.stack([both.real, -both.imag], axis=-1).reshape(len(rows), -1).T
    return _Blocks(np.hstack([own, parts]), np.ascontiguousarray(states), poles**size)
