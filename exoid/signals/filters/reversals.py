"""Reversals of joints with sharp friction: pulses of unknown friction, and the rows without them."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .low_pass import noise_bandwidth
from .parallel import ParallelFilter


def around_stops(slow: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.bool_]:
    """Widen the reversals of joints, and leave out rests."""
    # The kinematics filter has about twice the cut-off f of the parallel filter, and rounds the corner that a stop
    # makes in the angle over 1 / (4π f).
    widened = np.zeros(slow.shape, dtype=np.bool_, order="F")
    grown = math.ceil(parallel.rate / (4.0 * math.pi * parallel.cutoff))
    for joint in range(slow.shape[1]):
        edges = np.flatnonzero(np.diff(slow[:, joint], prepend=False, append=False))
        for start, end in edges.reshape(-1, 2).tolist():
            if end - start <= parallel.rate:  # a stay of more than 1 s is a rest: its rows are kept
                widened[max(0, start - grown) : end + grown, joint] = True
    return widened


def reversal_pulses(unknown: NDArray[np.bool_], parallel: ParallelFilter) -> NDArray[np.intp]:
    """Place pulses from end to end of each reversal, at most a quarter of the cut-off's period apart."""
    start, end = np.flatnonzero(np.diff(unknown, prepend=False, append=False)).reshape(-1, 2).T
    gaps = np.ceil((end - start) * (4.0 * parallel.cutoff / parallel.rate)).astype(np.intp)
    run = np.repeat(np.arange(len(start)), gaps + 1)
    number = np.arange(len(run)) - np.repeat(np.cumsum(gaps + 1) - (gaps + 1), gaps + 1)
    return np.unique(np.rint(start[run] + number * ((end - 1 - start) / gaps)[run]).astype(np.intp))


def without_reversals(
    signals: Sequence[FloatArray],
    pulses: Sequence[NDArray[np.intp]],
    rows: range,
    parallel: ParallelFilter,
    block: int | None = None,
) -> list[tuple[FloatArray, FloatArray, float]]:
    """Project the filtered columns and torque of each joint onto the complement of the pulses at its reversals.

    Of each joint is returned what is left of them, (K, R), what was taken out, in an orthonormal basis, (K, M), and the
    share of the energy of filtered white noise that is left.
    """
    # A joint with sharp friction sticks where it turns round. Its friction is then what holds it, anywhere
    # between −c0 and c0, and no term says how much. Doc. 1, sec. III-G, leaves such samples out. Behind a
    # low-pass they cannot be left out: the filter has spread their torque over the rows around them. But it is
    # linear. Unknown friction is a sum of pulses at the reversal, and behind the filter a sum of its impulse
    # responses h:
    #
    #     (h * τ)_k = (h * W)_k β + Σ_i p_i h(t_k − t_i).
    #
    # Both sides are projected onto the complement of these pulses, which is the same as to fit every p_i. Pulses are so
    # close together that the filter could not tell more of them apart.
    left = [of_joint.copy() for of_joint in signals]
    taken = [[np.zeros((len(of_joint), 0))] for of_joint in signals]
    energy = np.zeros(len(left))
    # about 256 rows, as far apart as the filter allows, are projected together
    size = max(1, 256 * parallel.stride // rows.step)  # of a piece, which may have half as many again
    blocks = range(0, len(rows), block or max(1, len(rows)))
    clusters = [
        _Cluster(joint, slice(first + piece.start, first + piece.stop), together)
        for joint, of_joint in enumerate(pulses)
        for first in blocks
        for piece, together in _clusters(rows[first : first + blocks.step], of_joint, size, parallel)
    ]
    correlation = _noise_correlations(parallel, rows.step, 2 * size)
    for alike, bases in _bases(clusters, rows, 2 * size, parallel):
        length = bases.shape[1]
        energies = np.einsum("clm,clm->c", bases, correlation[:length, :length] @ bases)
        for (joint, piece, _), basis, of_noise in zip(alike, bases, energies.tolist(), strict=True):
            part = left[joint][:, piece]
            Q = basis[: part.shape[1]]
            taken[joint].append(part @ Q)
            part -= taken[joint][-1] @ Q.T
            energy[joint] += of_noise
    shares = 1.0 - energy / max(len(rows), 1)
    return [(x, np.hstack(y), share) for x, y, share in zip(left, taken, shares.tolist(), strict=True)]


class _Cluster(NamedTuple):
    """Pulses whose responses overlap: the space of other pulses is orthogonal to theirs."""

    joint: int  # index of the joint
    piece: slice  # rows that they reach
    pulses: list[int]  # samples of the pulses


def _clusters(
    rows: range, pulses: NDArray[np.intp], size: int, parallel: ParallelFilter
) -> Iterator[tuple[slice, list[int]]]:
    """Go over clusters of pulses, and the rows that they reach, piece by piece, but for pieces with too many."""
    reach = len(_impulse_response(parallel)) // 2
    pulses = pulses[slice(*np.searchsorted(pulses, [rows.start - reach, rows.stop + reach]))]
    # Rows are cut into pieces of half to one and a half times a size, as far from pulses as possible: a pulse near a
    # cut is fitted in both pieces, which takes out more than is unknown.
    k = np.arange(rows.start, rows.stop, rows.step)
    after = np.searchsorted(pulses, k)
    around = np.concatenate([[-np.inf], pulses, [np.inf]])
    distance, cuts = np.minimum(k - around[after], around[after + 1] - k), [0]
    while len(k) - cuts[-1] > 3 * size // 2:
        earliest = cuts[-1] + max(1, size // 2)
        cuts.append(earliest + int(np.argmax(distance[earliest : cuts[-1] + 3 * size // 2])))
    # Where pulses would take more than this share of the independent samples of a piece, its rows stay
    places, most = pulses.tolist(), 0.7 * min(1.0, noise_bandwidth(parallel.rate, parallel.cutoff) * rows.step)
    for start, stop in pairwise([*cuts, len(k)]):
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
    clusters: Iterable[_Cluster], rows: range, longest: int, parallel: ParallelFilter
) -> Iterator[tuple[list[_Cluster], FloatArray]]:
    """Find orthonormal bases of the filtered pulses of clusters, for all of as many pulses at once."""
    responses = _responses(parallel, rows.step, longest)
    by_count: defaultdict[int, list[_Cluster]] = defaultdict(list)
    for cluster in clusters:
        by_count[len(cluster.pulses)].append(cluster)
    for alike in by_count.values():
        start, stop = np.array([(cluster.piece.start, cluster.piece.stop) for cluster in alike]).T[..., np.newaxis]
        later, phase = np.divmod(rows.start + rows.step * start - [cluster.pulses for cluster in alike], rows.step)
        inside = np.arange((stop - start).max()) < stop - start
        B = responses[phase, later + responses.shape[1] // 2, : inside.shape[1]].transpose(0, 2, 1)
        yield alike, np.linalg.qr(B * inside[..., np.newaxis]).Q * inside[..., np.newaxis]


@lru_cache(maxsize=4)
def _noise_correlations(parallel: ParallelFilter, step: int, count: int) -> FloatArray:
    """Correlation of filtered white noise between so many samples, ``step`` apart, (``count``, ``count``)."""
    response = _impulse_response(parallel)
    later = scipy.signal.fftconvolve(response, response)[len(response) - 1 :: step]
    correlation = np.zeros(count)
    correlation[: len(later)] = (later / later[0])[:count]
    return np.asarray(scipy.linalg.toeplitz(correlation))


@lru_cache(maxsize=16)
def _impulse_response(parallel: ParallelFilter) -> FloatArray:
    """Impulse response of the filter, its largest value in the middle, cut off where it is over, (2 M + 1,)."""
    reach = parallel.reach
    impulse = np.zeros((1, 2 * reach + 1))
    impulse[0, reach] = 1.0
    response = parallel.among_zeros(impulse, range(2 * reach + 1))[0]
    lasting = np.flatnonzero(np.abs(response) > 1e-4 * response.max())
    half = int(np.abs(lasting - reach).max())
    return np.asarray(response[reach - half : reach + half + 1])


@lru_cache(maxsize=16)
def _responses(parallel: ParallelFilter, step: int, count: int) -> FloatArray:
    """Impulse response at every ``step``-th sample from each of so many first ones, zero where it is over."""
    response = _impulse_response(parallel)
    reach = len(response) // 2
    half = count + -(-reach // step) + 1
    padded = np.zeros((2 * half + count - 1) * step)
    padded[half * step - reach : half * step + reach + 1] = response
    by_phase = np.ascontiguousarray(padded.reshape(-1, step).T)
    return sliding_window_view(by_phase, count, axis=1)
