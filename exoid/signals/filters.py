"""Low-pass filters: zero-phase (forward and backward), the parallel filter, and the causal moving average of doc. 2."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.lib.stride_tricks import sliding_window_view
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

BLOCK = 128
"""Samples of a block of the parallel filter, about."""

DECAYED = 1e-20
"""Part of a state that has decayed."""

LONGEST_REVERSAL = 1.0
"""A longer stay below the reversal speed is a rest [s]: its rows are kept."""

PIECE = 256
"""Rows that are projected together, about, if they are as far apart as the filter allows."""

LONGEST_PIECE = 2
"""Such a piece is never longer than so many times that."""

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
    """Decompose the impulse response of `zero_phase` into decaying modes, h_k = Re Σ c_i p_i^(|k| − 1) for k ≠ 0.

    Modes are the poles of one pass. Of two that are conjugates of each other, one is left, with twice the weight.

    Args:
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the two passes together [Hz].
        order: Order of one pass.

    Returns:
        Poles p and weights c, (m,) each, and h_0.

    Raises:
        ExoidError: The cut-off is not between 0 and half the rate.
    """
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
            window = np.pad(window, ((0, 0), beyond), mode="reflect", reflect_type="odd")
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
    """The filter for blocks of B samples, at every step-th of them.

    The impulse response is a sum of decaying modes, h_k = Re Σ c_i p_i^(|k| − 1) for k ≠ 0. What samples far from a
    block add to its rows is therefore said by one complex number a mode and side, Σ x_j p_i^j, the *states*.

    Attributes:
        products: What samples of a block add to its own rows, and to the states of the blocks after and before it,
            (B, M + 4 m) with M rows a block, m modes, and real and imaginary parts one after the other.
        states: What states add to the rows of a block, (4 m, M).
        decay: Factor of a state from block to block, (m,).
    """

    products: FloatArray
    states: FloatArray
    decay: ComplexArray

    @property
    def size(self) -> int:
        """Samples of a block."""
        return len(self.products)

    def joined(self, products: FloatArray) -> FloatArray:
        """Add what comes from other blocks.

        Args:
            products: Blocks times :attr:`products`, (blocks, K, M + 4 m).

        Returns:
            Filtered rows, (blocks, K, M).
        """
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
    widened = np.zeros(slow.shape, dtype=np.bool_, order="F")
    grown = math.ceil(parallel.rate / (4.0 * math.pi * parallel.cutoff))
    for joint in range(slow.shape[1]):
        for start, end in _runs(slow[:, joint]):
            if end - start <= LONGEST_REVERSAL * parallel.rate:
                widened[max(0, start - grown) : end + grown, joint] = True
    return widened


def reversal_pulses(unknown: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.intp]:
    """Place pulses from end to end of each reversal, at most a quarter of the cut-off's period apart.

    Args:
        unknown: Whether the friction of a joint is unknown, for all samples, (N,).
        parallel: Filter of the rows.

    Returns:
        Samples of the pulses in ascending order, (M,).
    """
    start, end = _runs(unknown).T
    gaps = np.ceil((end - start) * (4.0 * parallel.cutoff / parallel.rate)).astype(np.intp)
    run = np.repeat(np.arange(len(start)), gaps + 1)
    number = np.arange(len(run)) - np.repeat(np.cumsum(gaps + 1) - (gaps + 1), gaps + 1)
    return np.unique(np.rint(start[run] + number * ((end - 1 - start) / gaps)[run]).astype(np.intp))


class Projected(NamedTuple):
    """Signals of a joint without the pulses at its reversals.

    Attributes:
        signals: What is left of them, (K, R).
        taken: What was taken out, in an orthonormal basis, (K, M).
        noise_left: Share of the energy of filtered white noise that is left.
    """

    signals: FloatArray
    taken: FloatArray
    noise_left: float


def without_reversals(
    signals: Sequence[FloatArray],
    pulses: Sequence[NDArray[np.intp]],
    rows: range,
    parallel: ParallelFilter,
    block: int | None = None,
) -> list[Projected]:
    """Project the filtered columns and torque of each joint onto the complement of the pulses at its reversals.

    A joint with sharp friction sticks where it turns round. Its friction is then what holds it, anywhere between −c0
    and c0, and no term says how much. Doc. 1, sec. III-G, leaves such samples out. Behind a low-pass they cannot be
    left out: the filter has spread their torque over the rows around them. But it is linear. Unknown friction is a sum
    of pulses at the reversal, and behind the filter a sum of its impulse responses h:

        (h * τ)_k = (h * W)_k β + Σ_i p_i h(t_k − t_i).

    Both sides are projected onto the complement of these pulses, which is the same as to fit every p_i. Pulses are so
    close together that the filter could not tell more of them apart.

    Args:
        signals: Filtered signals of each joint at some samples, (K, R).
        pulses: Samples of the pulses of each joint, see :func:`reversal_pulses`.
        rows: These samples, R of them.
        parallel: The filter.
        block: Number of rows that are cut into pieces by themselves, so that the pieces do not depend on how many rows
            there are; None for all.

    Returns:
        Projected signals of each joint.
    """
    left = [of_joint.copy() for of_joint in signals]
    taken = [[np.zeros((len(of_joint), 0))] for of_joint in signals]
    energy = np.zeros(len(left))
    size = max(1, PIECE * parallel.stride // rows.step)
    blocks = range(0, len(rows), block or max(1, len(rows)))
    clusters = [
        _Cluster(joint, slice(first + piece.start, first + piece.stop), together)
        for joint, of_joint in enumerate(pulses)
        for first in blocks
        for piece, together in _clusters(rows[first : first + blocks.step], of_joint, size, parallel)
    ]
    correlation = _noise_correlations(parallel, rows.step, LONGEST_PIECE * size)
    for alike, bases in _bases(clusters, rows, size, parallel):
        length = bases.shape[1]
        energies = np.einsum("clm,clm->c", bases, correlation[:length, :length] @ bases)
        for (joint, piece, _), basis, of_noise in zip(alike, bases, energies.tolist(), strict=True):
            part = left[joint][:, piece]
            Q = basis[: part.shape[1]]
            taken[joint].append(part @ Q)
            part -= taken[joint][-1] @ Q.T
            energy[joint] += of_noise
    shares = 1.0 - energy / max(len(rows), 1)
    return [Projected(x, np.hstack(y), share) for x, y, share in zip(left, taken, shares.tolist(), strict=True)]


class _Cluster(NamedTuple):
    """Pulses whose responses overlap: the space of other pulses is orthogonal to theirs.

    Attributes:
        joint: Index of the joint.
        piece: Rows that they reach.
        pulses: Samples of the pulses.
    """

    joint: int
    piece: slice
    pulses: list[int]


def _clusters(
    rows: range, pulses: NDArray[np.intp], size: int, parallel: ParallelFilter
) -> Iterator[tuple[slice, list[int]]]:
    """Go over clusters of pulses, and the rows that they reach, piece by piece, but for pieces with too many."""
    reach = len(_impulse_response(parallel)) // 2
    pulses = pulses[slice(*np.searchsorted(pulses, [rows.start - reach, rows.stop + reach]))]
    places, most = pulses.tolist(), LARGEST_SHARE * min(1.0, parallel.independent_fraction * rows.step)
    for start, stop in pairwise(_cuts(rows, pulses, size)):
        near = places[bisect_left(places, rows[start] - reach) : bisect_right(places, rows[stop - 1] + reach)]
        if not 0 < len(near) <= most * (stop - start):
            continue
        gaps = [k for k, (before, after) in enumerate(pairwise(near), 1) if after - before > 2 * reach]
        for first, end in pairwise([0, *gaps, len(near)]):
            together = near[first:end]
            earliest = max(start, -((rows.start + reach - together[0]) // rows.step))
            latest = min(stop, (together[-1] + reach - rows.start) // rows.step + 1)
            yield slice(earliest, latest), together


def _bases(
    clusters: Iterable[_Cluster], rows: range, size: int, parallel: ParallelFilter
) -> Iterator[tuple[list[_Cluster], FloatArray]]:
    """Find orthonormal bases of the filtered pulses of clusters, for all of as many pulses at once.

    Args:
        clusters: Clusters of pulses.
        rows: Filtered samples.
        size: Number of rows of a piece, about.
        parallel: The filter.

    Yields:
        C clusters, and their bases, zero behind the last row of each, (C, L, M).
    """
    responses = _responses(parallel, rows.step, LONGEST_PIECE * size)
    by_count: defaultdict[int, list[_Cluster]] = defaultdict(list)
    for cluster in clusters:
        by_count[len(cluster.pulses)].append(cluster)
    for alike in by_count.values():
        start, stop = np.array([(cluster.piece.start, cluster.piece.stop) for cluster in alike]).T[..., np.newaxis]
        later, phase = np.divmod(rows.start + rows.step * start - [cluster.pulses for cluster in alike], rows.step)
        inside = np.arange((stop - start).max()) < stop - start
        B = responses[phase, later + responses.shape[1] // 2, : inside.shape[1]].transpose(0, 2, 1)
        yield alike, np.linalg.qr(B * inside[..., np.newaxis]).Q * inside[..., np.newaxis]


def _cuts(rows: range, pulses: NDArray[np.intp], size: int) -> list[int]:
    """Cut rows into pieces of half to one and a half times a size, as far from pulses as possible.

    A pulse near a cut is fitted in both pieces, which takes out more than is unknown.
    """
    k = np.arange(rows.start, rows.stop, rows.step)
    after = np.searchsorted(pulses, k)
    around = np.concatenate([[-np.inf], pulses, [np.inf]])
    distance = np.minimum(k - around[after], around[after + 1] - k)
    cuts = [0]
    while len(k) - cuts[-1] > 3 * size // 2:
        first = cuts[-1] + max(1, size // 2)
        cuts.append(first + int(np.argmax(distance[first : cuts[-1] + 3 * size // 2])))
    return [*cuts, len(k)]


@lru_cache(maxsize=4)
def _noise_correlations(parallel: ParallelFilter, step: int, count: int) -> FloatArray:
    """Correlation of filtered white noise between so many samples, ``step`` apart, (``count``, ``count``)."""
    correlation = np.zeros(count)
    later = _noise_correlation(parallel, step)[:count]
    correlation[: len(later)] = later
    return np.asarray(scipy.linalg.toeplitz(correlation))


@lru_cache(maxsize=16)
def _noise_correlation(parallel: ParallelFilter, step: int) -> FloatArray:
    """Correlation of filtered white noise with that 0, ``step``, 2 ``step``, … samples later, (M + 1,)."""
    response = _impulse_response(parallel)
    later = scipy.signal.fftconvolve(response, response)[len(response) - 1 :: step]
    return np.asarray(later / later[0])


def _runs(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First sample of each run, and the first behind it, (M, 2)."""
    inner = np.flatnonzero(mask[1:] != mask[:-1]) + 1
    first, last = (np.flatnonzero(mask[edge]) for edge in (slice(0, 1), slice(-1, None)))
    return np.concatenate([first, inner, last + len(mask)]).reshape(-1, 2)


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
def _responses(parallel: ParallelFilter, step: int, count: int) -> FloatArray:
    """Impulse response at every ``step``-th sample from each of so many first ones, zero where it is over.

    Args:
        parallel: The filter.
        step: Step.
        count: Largest number of samples that are wanted at once.

    Returns:
        View of the response at the lags ``step`` k + phase, ``step`` (k + 1) + phase, …
        for each phase and k from −M, (``step``, 2 M, ``count``).
    """
    response = _impulse_response(parallel)
    reach = len(response) // 2
    half = count + -(-reach // step) + 1
    padded = np.zeros((2 * half + count - 1) * step)
    padded[half * step - reach : half * step + reach + 1] = response
    by_phase = np.ascontiguousarray(padded.reshape(-1, step).T)
    return sliding_window_view(by_phase, count, axis=1)
