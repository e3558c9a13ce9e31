"""Data that occur twice: the same log passed again, and parts of one log that overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.estimate.finding import Finding
from exoid.signals import Recording

MOST_COMPARED = 1_000_000
"""Recordings with more samples in all are not searched for data that occur twice."""

SAME_ROWS = 0.05
"""Recordings that share this part of their samples contain the same data twice."""

SAMPLE = np.uint64(7)
"""Whether anything occurs twice is first seen on the rows whose hash has these bits zero."""


class Overlap(NamedTuple):
    """Two recordings that contain the same samples."""

    first: int  # place of the earlier one
    second: int  # place of the later one
    share: float  # shared samples over those of the shorter one
    again: BoolArray  # samples of the later one that occur in the earlier one, (N,)


def overlaps(recordings: Sequence[Recording]) -> Iterator[Overlap]:
    """Find recordings that contain the same samples; only samples that count are compared.

    Args:
        recordings: The recordings, of the same joints.

    Yields:
        Each pair that shares more than :data:`SAME_ROWS`.
    """
    if len(recordings) < 2 or sum(map(len, recordings)) > MOST_COMPARED:
        return
    hashes = [_hashes(one) for one in recordings]
    counted = [own if one.mask is None else own[one.mask] for own, one in zip(hashes, recordings, strict=True)]
    common = _common(counted)
    rows = [np.intersect1d(_distinct(own), common) for own in counted]
    for first, second in combinations([k for k, own in enumerate(rows) if len(own)], 2):
        shortest = max(1, min(len(counted[first]), len(counted[second])))
        share = len(np.intersect1d(rows[first], rows[second])) / shortest
        if share > SAME_ROWS:
            yield Overlap(first, second, share, np.isin(hashes[second], counted[first]))


def repeated_data(
    recordings: Sequence[Recording], names: Sequence[str], parameters: Sequence[str]
) -> Iterator[Finding]:
    """Report recordings that contain the same samples, where these count twice."""
    for first, second, share, _ in overlaps(recordings):
        yield Finding(
            "repeated-data",
            "",
            share,
            "1",
            "warning",
            f"{names[first] or first + 1} and {names[second] or second + 1} share {share:.0%} of their samples, "
            "which count twice: intervals are too narrow",
            "pass every sample once",
            parameters=tuple(parameters),
        )


def _common(hashes: Sequence[NDArray[np.uint64]]) -> NDArray[np.uint64]:
    """Rows that occur once in each of several recordings."""
    if len(hashes) < 2:
        return np.zeros(0, dtype=np.uint64)
    sample = np.concatenate([rows[rows & SAMPLE == 0] for rows in hashes])
    if (np.diff(np.sort(sample)) != 0).all():
        return sample[:0]
    every = [_distinct(rows) for rows in hashes]
    values, counts = np.unique(np.concatenate(every), return_counts=True)
    return np.asarray(values[counts > 1])


def _distinct(hashes: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Rows that occur once: a leg at rest may give the same row at any time."""
    values, counts = np.unique(hashes, return_counts=True)
    return np.asarray(values[counts == 1])


def _hashes(recording: Recording) -> NDArray[np.uint64]:
    """Hash of the angles and torques of each sample, whatever its time, (N,)."""
    rows = _with_torque(recording)
    factors = np.random.default_rng(0).integers(1, 2**63, rows.shape[1], dtype=np.uint64) | np.uint64(1)
    bits = rows.view(np.uint64)
    mixed = (bits ^ (bits >> np.uint64(29))) * factors
    return np.asarray((mixed ^ (mixed >> np.uint64(32))).sum(axis=1, dtype=np.uint64))


def _with_torque(recording: Recording) -> FloatArray:
    columns = [recording.q] if recording.tau is None else [recording.q, recording.tau]
    return np.ascontiguousarray(np.hstack(columns), dtype=np.float64) + 0.0  # no negative zero
