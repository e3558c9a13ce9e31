"""Reversals: where a joint turns round its friction is not known, and is projected out of filtered rows."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
import scipy  # its parts load when they are first used
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .parallel_filter import ParallelFilter

LONGEST_REVERSAL = 1.0
"""A longer stay below the reversal speed is a rest [s]: its rows are kept."""

PIECE = 256
"""Rows that are projected together, about, if they are as far apart as the filter allows."""

LONGEST_PIECE = 2
"""Such a piece is never longer than so many times that."""

LARGEST_SHARE = 0.7
"""Share of the independent samples of a piece that pulses may take; where there are more, the rows stay."""

COARSE = 64
"""Lengths of Fourier transforms are rounded up to so many rows, so that several are worked out at once."""

NEGLIGIBLE = 1e-4
"""Part of the largest response below which a response is over."""


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


def without_reversals(
    signals: FloatArray, pulses: NDArray[np.intp], rows: range, parallel: ParallelFilter
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
        pulses: Samples of the pulses of the joint, see :func:`reversal_pulses`.
        rows: These samples, R of them.
        parallel: The filter.

    Returns:
        Projected signals, (K, R); what was taken out of them, in an orthonormal basis, (K, M); and the share of the
        energy of filtered white noise that is left.
    """
    out, size = signals.copy(), max(1, PIECE * parallel.stride // rows.step)
    reach, responses = _responses(parallel, rows.step, LONGEST_PIECE * size)
    taken, bases = [np.zeros((len(signals), 0))], []
    for piece, together in _clusters(rows, pulses, size, reach, parallel.independent_fraction):
        later, phase = np.divmod(rows[piece.start] - together, rows.step)
        B = responses[phase, later + responses.shape[1] // 2, : piece.stop - piece.start].T
        factored, tau, *_ = scipy.linalg.lapack.dgeqrf(B, overwrite_a=1)  # a third of numpy's time
        Q, *_ = scipy.linalg.lapack.dorgqr(factored[:, : len(factored)], tau, overwrite_a=1)
        taken.append(out[:, piece] @ Q)
        out[:, piece] -= taken[-1] @ Q.T
        bases.append(Q)
    share = _share_of_noise(bases, parallel, rows.step) / max(len(rows), 1)
    return out, np.hstack(taken), 1.0 - share


def _clusters(
    rows: range, pulses: NDArray[np.intp], size: int, reach: int, independent_fraction: float
) -> Iterator[tuple[slice, NDArray[np.intp]]]:
    """Go over pulses whose responses overlap, piece by piece, with the rows that they reach: others are orthogonal."""
    first, end = np.searchsorted(pulses, [rows.start - reach, rows.stop + reach])
    pulses = pulses[first:end]
    for piece in _pieces(rows, pulses, size):
        begin, count = rows[piece.start], piece.stop - piece.start
        near = pulses[slice(*np.searchsorted(pulses, [begin - reach, rows[piece.stop - 1] + reach + 1]))]
        if not 0 < len(near) <= LARGEST_SHARE * count * min(1.0, independent_fraction * rows.step):
            continue
        cuts = np.flatnonzero(near[1:] - near[:-1] > 2 * reach) + 1
        for start, stop in pairwise([0, *cuts.tolist(), len(near)]):
            together = near[start:stop]
            earliest = max(0, -((begin + reach - together[0]) // rows.step))
            latest = min(count, (together[-1] + reach - begin) // rows.step + 1)
            yield slice(piece.start + int(earliest), piece.start + int(latest)), together


def _share_of_noise(bases: Sequence[FloatArray], parallel: ParallelFilter, step: int) -> float:
    """Energy Σ qᵀ C q of filtered white noise of variance 1 along all columns q of orthonormal bases.

    C is the correlation of the noise. By Parseval's theorem the sum is that of |q̂|² ĉ over the frequencies of an FFT
    that is long enough for each q and every lag.
    """
    by_length: defaultdict[int, list[FloatArray]] = defaultdict(list)
    lags = len(_noise_correlation(parallel, step))
    for Q in bases:
        rounded = -(-len(Q) // COARSE) * COARSE
        by_length[scipy.fft.next_fast_len(rounded + lags, real=True)].append(Q)
    total = 0.0
    for length, several in by_length.items():
        padded = np.zeros((sum(Q.shape[1] for Q in several), length))
        place = 0
        for Q in several:
            padded[place : place + Q.shape[1], : len(Q)] = Q.T
            place += Q.shape[1]
        q = scipy.fft.rfft(padded, axis=1).view(np.float64)
        power = np.einsum("kf,kf->f", q, q).reshape(-1, 2).sum(axis=1)
        total += float(power @ _noise_spectrum(parallel, step, length))
    return total


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


@lru_cache(maxsize=64)
def _noise_spectrum(parallel: ParallelFilter, step: int, length: int) -> FloatArray:
    """Weights ĉ of the frequencies of an FFT of real numbers, over its length; those above half the rate are added."""
    later = _noise_correlation(parallel, step)
    circular = np.zeros(length)
    circular[: len(later)] = later
    circular[length - len(later) + 1 :] += later[:0:-1]
    spectrum = 2.0 * scipy.fft.rfft(circular).real / length
    spectrum[0] /= 2.0
    if length % 2 == 0:
        spectrum[-1] /= 2.0
    return np.asarray(spectrum)


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
def _responses(parallel: ParallelFilter, step: int, count: int) -> tuple[int, FloatArray]:
    """Impulse response at every ``step``-th sample from each of so many first ones, zero where it is over.

    Args:
        parallel: The filter.
        step: Step.
        count: Largest number of samples that are wanted at once.

    Returns:
        Its length to each side; and a view of the response at the lags ``step`` k + phase, ``step`` (k + 1) + phase, …
        for each phase and k from −M, (``step``, 2 M, ``count``).
    """
    response = _impulse_response(parallel)
    reach = len(response) // 2
    half = count + -(-reach // step) + 1
    padded = np.zeros((2 * half + count - 1) * step)
    padded[half * step - reach : half * step + reach + 1] = response
    by_phase = np.ascontiguousarray(padded.reshape(-1, step).T)
    return reach, sliding_window_view(by_phase, count, axis=1)
