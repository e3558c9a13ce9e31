"""Low-pass filters: zero-phase (forward and backward), the parallel filter, and the causal moving average of doc. 2."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any

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

OVERSAMPLING = 4.0
"""Rows per row of independent noise, so that products of two filtered signals do not alias onto frequency zero."""


LONGEST_REVERSAL = 1.0
"""A longer stay below the reversal speed is a rest [s]: its rows are kept."""

PIECE = 256
"""Rows that are projected together, about, if they are as far apart as the filter allows."""

LARGEST_SHARE = 0.7
"""Share of the independent samples of a piece that pulses may take; where there are more, the rows stay."""

NEGLIGIBLE = 1e-4
"""Part of the largest response below which a response is over."""

REFLECTION: dict[str, Any] = {"mode": "reflect", "reflect_type": "odd"}
"""Arguments of `numpy.pad` that reflect a signal about its end points."""


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
    sections = scipy.signal.butter(order, design_frequency(rate, cutoff, order), fs=rate, output="sos")
    signals = x.reshape(len(x), -1).T
    out = np.empty(signals.shape)
    width = max(1, BLOCK_BYTES // (8 * len(x)))
    for first in range(0, len(signals), width):
        rows = slice(first, first + width)
        filtered = scipy.signal.sosfiltfilt(sections, extend(signals[rows]), padtype=None, padlen=0)
        out[rows] = filtered[:, pad:-pad]
    return out.T.reshape(x.shape)


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
    zeros, poles, gain = scipy.signal.butter(order, design_frequency(rate, cutoff, order), fs=rate, output="zpk")
    radius = float(np.abs(poles).max())
    if radius < 1e-9:  # all poles at the origin: the response is over after one sample
        return 1
    others = poles[:, np.newaxis] - poles + np.eye(len(poles))
    residues = gain * np.prod(poles[:, np.newaxis] - zeros, axis=1) / np.prod(others, axis=1)
    mirrored = gain * np.prod(1 - np.outer(poles, zeros), axis=1) / np.prod(1 - np.outer(poles, poles), axis=1)
    envelope = 2.0 * float(np.abs(residues * mirrored / (1 - poles)).sum())
    return max(1, math.ceil(math.log(tolerance / envelope) / math.log(radius)))


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


def exponential_moving_average(x: FloatArray, alpha: float) -> FloatArray:
    """Smooth columns as in doc. 2, sec. III: y_k = α x_k + (1 − α) y_{k−1}, from y_0 = x_0.

    The filter is causal: it delays a ramp by (1 − α)/α samples.

    Args:
        x: Signals in any unit, (N, ...); filtered along the first axis.
        alpha: Weight of the newest sample, 0 < α ≤ 1; 1 does not change ``x``.

    Returns:
        Smoothed signals, of the shape of ``x``.

    Raises:
        ExoidError: α is outside (0, 1].
    """
    if not 0.0 < alpha <= 1.0:
        raise ExoidError(f"alpha is {alpha}", remedy="pass 0 < alpha ≤ 1, the weight of the newest sample")
    smoothed, _ = scipy.signal.lfilter([alpha], [1.0, alpha - 1.0], x, axis=0, zi=(1.0 - alpha) * x[:1])
    return np.asarray(smoothed, dtype=np.float64)


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
    """Zero-phase Butterworth filter, as :func:`exoid.signals.zero_phase`, by its gain in the frequency domain.

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
        first, last, step = rows[0] - self.reach, rows[-1] + 1 + self.reach, rows.step
        beyond = max(0, -first), max(0, last - signals.shape[1])
        window = signals[:, max(0, first) : last]
        if any(beyond):
            window = np.pad(window, ((0, 0), beyond), mode="reflect", reflect_type="odd")
        # y = irfft(gain · rfft(x)) at every step-th sample: its spectrum is the whole one, aliased step times
        count = scipy.fft.next_fast_len(-(-window.shape[1] // (2 * step)), real=True)
        gain = _shifted_gain(self, 2 * step * count, self.reach)
        spectrum = scipy.fft.rfft(window, 2 * step * count, axis=1)
        spectrum *= gain
        return np.asarray(scipy.fft.irfft(_fold(spectrum, step), 2 * count, axis=1)[:, : len(rows)])


def _fold(spectrum: ComplexArray, step: int) -> ComplexArray:
    """Spectrum of every step-th sample: the mean over all frequencies that alias onto each other, (K, F)."""
    width = (spectrum.shape[1] - 1) // step  # half of the remaining samples
    folded = spectrum[:, : width + 1].copy()
    for k in range(1, step):  # parts of the spectrum alternate: upwards, then downwards and conjugated
        part = spectrum[:, k * width : (k + 1) * width + 1]
        folded += part if k % 2 == 0 else np.conj(part[:, ::-1])
    return folded / step


@lru_cache(maxsize=16)
def _shifted_gain(filter_: ParallelFilter, samples: int, early: int) -> ComplexArray:
    """Gain at the frequencies of an FFT of ``samples`` samples, times an advance by ``early`` samples."""
    turn = np.arange(samples // 2 + 1) / samples
    gain = zero_phase_gain(turn * filter_.rate, filter_.rate, filter_.cutoff, filter_.order)
    shifted: ComplexArray = gain * np.exp(2j * np.pi * turn * early)
    shifted.flags.writeable = False
    return shifted


def around_stops(slow: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.bool_]:
    """Widen the reversals of joints, and leave out rests.

    The kinematics filter has about twice the cut-off f of the parallel filter, and rounds the corner that a stop makes
    in the angle over 1 / (4π f).

    Args:
        slow: Whether each joint is slower than its reversal speed, (N, n).
        parallel: Filter of the rows.

    Returns:
        Whether the friction of each joint is unknown, (N, n).
    """
    widened = np.zeros_like(slow)
    grown = math.ceil(parallel.rate / (4.0 * math.pi * parallel.cutoff))
    for joint in range(slow.shape[1]):
        for start, end in _runs(slow[:, joint]):
            if end - start <= LONGEST_REVERSAL * parallel.rate:
                widened[max(0, start - grown) : end + grown, joint] = True
    return widened


def without_reversals(
    signals: FloatArray, unknown: NDArray[np.bool_], rows: range, parallel: ParallelFilter
) -> tuple[FloatArray, FloatArray, float]:
    """Project the filtered columns and torque of a joint onto the complement of the pulses at its reversals.

    A joint with sharp friction sticks where it turns round. Its friction is then what holds it, anywhere between −c0
    and c0, and no term says how much. Doc. 1, sec. III-G, leaves such samples out. Behind a low-pass they cannot be
    left out: the filter has spread their torque over the rows around them. But it is linear. Unknown friction is a sum
    of pulses at the reversal, and behind the filter a sum of its impulse responses h:

        (h * τ)_k = (h * W)_k β + Σ_i p_i h(t_k − t_i).

    Both sides are projected onto the complement of these pulses, which is the same as to fit every p_i. Pulses are so
    close together that the filter could not tell more of them apart.

    Args:
        signals: Filtered signals at some samples, (K, R).
        unknown: Whether the friction of the joint is unknown, for all samples, (N,).
        rows: These samples, R of them.
        parallel: The filter.

    Returns:
        Projected signals, (K, R); what was taken out of them, in an orthonormal basis, (K, M); and the share of the
        energy of filtered white noise that is left.
    """
    out, response = signals.copy(), _impulse_response(parallel)
    reach = len(response) // 2
    margin = reach + 2 * math.ceil(LONGEST_REVERSAL * parallel.rate)  # longer than any reversal that is taken out
    first = max(0, rows.start - margin)
    pulses = first + _pulses(unknown[first : rows.stop + margin], parallel)
    taken, bases = [np.zeros((len(signals), 0))], []
    ends = np.searchsorted(pulses, [rows.start - reach, rows.stop + reach])
    pulses = pulses[ends[0] : ends[1]]
    for piece in _pieces(rows, pulses, max(1, PIECE * parallel.stride // rows.step)):
        begin, last = rows[piece.start], rows[piece.stop - 1]
        near = slice(*np.searchsorted(pulses, [begin - reach, last + reach + 1]))
        count, number = piece.stop - piece.start, near.stop - near.start
        independent = count * min(1.0, parallel.independent_fraction * rows.step)
        if 0 < number <= LARGEST_SHARE * independent:
            lags = (begin - pulses[near])[:, None] + rows.step * np.arange(count)
            B = _padded_response(parallel).take(lags + reach + 1, mode="clip").T
            Q, *_ = scipy.linalg.lapack.dorgqr(*scipy.linalg.lapack.dgeqrf(B)[:2])  # a third of numpy's time
            taken.append(out[:, piece] @ Q)
            out[:, piece] -= taken[-1] @ Q.T
            bases.append(Q)
    share = _share_of_noise(bases, parallel, rows.step) / max(len(rows), 1)
    return out, np.hstack(taken), 1.0 - share


def _share_of_noise(bases: Sequence[FloatArray], parallel: ParallelFilter, step: int) -> float:
    """Energy Σ qᵀ C q of filtered white noise of variance 1 along all columns q of orthonormal bases.

    C is the correlation of the noise. By Parseval's theorem the sum is that of |q̂|² ĉ over the frequencies of an FFT
    that is long enough for each q and every lag.
    """
    if not bases:
        return 0.0
    later = _noise_correlation(parallel, step)
    length = scipy.fft.next_fast_len(max(len(Q) for Q in bases) + len(later), real=True)
    padded = np.zeros((sum(Q.shape[1] for Q in bases), length))
    place = 0
    for Q in bases:
        padded[place : place + Q.shape[1], : len(Q)] = Q.T
        place += Q.shape[1]
    q = scipy.fft.rfft(padded, axis=1).view(np.float64)
    power = np.einsum("kf,kf->f", q, q).reshape(-1, 2).sum(axis=1)
    circular = np.zeros(length)
    circular[: len(later)] = later
    circular[length - len(later) + 1 :] += later[:0:-1]
    both = np.full(len(power), 2.0)  # frequencies above half the rate are those below it, conjugated
    both[0] = 1.0
    if length % 2 == 0:
        both[-1] = 1.0
    return float((both * power) @ scipy.fft.rfft(circular).real / length)


def _pieces(rows: range, pulses: NDArray[np.intp], size: int) -> Iterator[slice]:
    """Cut rows into pieces of half to one and a half times a size, as far from pulses as possible.

    A pulse near a cut is fitted in both pieces, which takes out more than is unknown.
    """
    k = np.arange(rows.start, rows.stop, rows.step)
    after = np.searchsorted(pulses, k)
    around = np.concatenate([[-np.inf], pulses, [np.inf]])
    distance = np.minimum(k - around[after], around[after + 1] - k)
    start = 0
    while len(k) - start > 3 * size // 2:
        first = start + max(1, size // 2)
        cut = first + int(np.argmax(distance[first : start + 3 * size // 2]))
        yield slice(start, cut)
        start = cut
    yield slice(start, len(k))


@lru_cache(maxsize=16)
def _noise_correlation(parallel: ParallelFilter, step: int) -> FloatArray:
    """Correlation of filtered white noise with that 0, ``step``, 2 ``step``, … samples later, (M + 1,)."""
    response = _impulse_response(parallel)
    later = scipy.signal.fftconvolve(response, response)[len(response) - 1 :: step]
    return np.asarray(later / later[0])


def _pulses(unknown: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.intp]:
    """Samples of the pulses: from end to end of each reversal, at most a quarter of the cut-off's period apart."""
    start, end = _runs(unknown).T
    gaps = np.ceil((end - start) * (4.0 * parallel.cutoff / parallel.rate)).astype(np.intp)
    run = np.repeat(np.arange(len(start)), gaps + 1)
    number = np.arange(len(run)) - np.repeat(np.cumsum(gaps + 1) - (gaps + 1), gaps + 1)
    return np.unique(np.rint(start[run] + number * ((end - 1 - start) / gaps)[run]).astype(np.intp))


def _runs(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First sample of each run, and the first behind it, (M, 2)."""
    return np.flatnonzero(np.diff(mask, prepend=False, append=False)).reshape(-1, 2)


@lru_cache(maxsize=16)
def _impulse_response(parallel: ParallelFilter) -> FloatArray:
    """Impulse response of the filter, its largest value in the middle, cut off where it is over, (2 M + 1,)."""
    reach = parallel.reach
    impulse = np.zeros((1, 2 * reach + 1))
    impulse[0, reach] = 1.0
    response = parallel(impulse, range(2 * reach + 1))[0]
    lasting = np.flatnonzero(np.abs(response) > NEGLIGIBLE * response.max())
    half = int(np.abs(lasting - reach).max())
    return np.asarray(response[reach - half : reach + half + 1])


@lru_cache(maxsize=16)
def _padded_response(parallel: ParallelFilter) -> FloatArray:
    """Impulse response of the filter with a zero before and behind it, (2 M + 3,)."""
    return np.pad(_impulse_response(parallel), 1)
