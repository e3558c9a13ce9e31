"""Data that occur twice: the same log passed again, and parts of one log that overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.findings import Finding
from exoid.signals import Poses, Recording, Recordings
from exoid.signals.recordings import RecordingFile

MOST_COMPARED = 1_000_000
"""Recordings with more samples in all are not searched for data that occur twice."""

SAME_ROWS = 0.05
"""Recordings that share this part of their samples contain the same data twice."""

FEWEST = 20
"""Fewest samples in a row that are the same data."""

SAMPLE = np.uint64(7)
"""Whether anything occurs twice is first seen on the rows whose hash has these bits zero."""

SOLID = 0.9
"""A stretch of a recording is the same as in another where this part of its samples is."""

SHORTEST = 3.0
"""A rest of a recording shorter than this [s] is left out too."""


class Once(NamedTuple):
    """Recordings without what occurs twice.

    Attributes:
        data: Recordings and poses.
        findings: What was left out.
    """

    data: Sequence[Recording | Poses]
    findings: tuple[Finding, ...]


def count_once(data: Sequence[Recording | Poses]) -> Once:
    """Leave out recordings that are passed twice, and stretches that an earlier recording contains.

    Of recordings on disk only paths are compared.

    Args:
        data: Recordings and poses.

    Returns:
        Those that remain, at least one, and findings that name what was left out.
    """
    if isinstance(data, Recordings):
        return _paths_once(data)
    if sum(len(one) for one in data) > MOST_COMPARED or len(data) < 2:
        return Once(data, ())
    hashes = [None if isinstance(one, Poses) else _hashes(one) for one in data]
    of_motions = [rows for rows in hashes if rows is not None]
    common = _common(of_motions)
    if not len(common):
        return Once(data, ())
    befores = [np.intersect1d(rows, common) for rows in of_motions]
    kept: list[Recording | Poses] = []
    findings, seen = [], 0
    for k, one in enumerate(data):
        parts = [one]
        if isinstance(one, Recording):
            for before in befores[:seen]:
                parts = [rest for part in parts for rest in _without(part, before)]
            seen += 1
        lost = len(one) - sum(len(part) for part in parts)
        if lost:
            findings.append(_counted_once(_name(one, k), lost / len(one)))
        kept += parts
    return Once(kept if findings else data, tuple(findings))


def repeated_data(
    recordings: Sequence[Recording], names: Sequence[str], parameters: Sequence[str]
) -> Iterator[Finding]:
    """Find recordings that contain the same samples.

    Args:
        recordings: The recordings.
        names: Their names.
        parameters: Names of all parameters.

    Yields:
        One finding for each pair.
    """
    if len(recordings) < 2:
        return
    hashes = [_hashes(one) for one in recordings]
    common = _common(hashes)
    rows = [np.intersect1d(_distinct(own), common) for own in hashes]
    for first, second in combinations([k for k, own in enumerate(rows) if len(own)], 2):
        shortest = max(1, min(len(recordings[first]), len(recordings[second])))
        share = len(np.intersect1d(rows[first], rows[second])) / shortest
        if share > SAME_ROWS:
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


def _paths_once(data: Recordings) -> Once:
    """Leave out files that are listed twice."""
    kept: dict[object, RecordingFile | Recording | Poses] = {}
    findings = []
    for item in data.items:
        key = item.path.resolve() if isinstance(item, RecordingFile) else id(item)
        if key in kept and isinstance(item, RecordingFile):
            findings.append(_counted_once(item.path.name, 1.0))
        kept.setdefault(key, item)
    return Once(Recordings(tuple(kept.values()), data.watch) if findings else data, tuple(findings))


def _without(one: Recording | Poses, before: NDArray[np.uint64]) -> Iterator[Recording | Poses]:
    """Cut out of a recording the stretch whose rows an earlier one contains."""
    stretch = _stretch(_hashes(one), before) if isinstance(one, Recording) and len(before) else None
    if stretch is None or isinstance(one, Poses):
        yield one
        return
    for part in (slice(0, stretch.start), slice(stretch.stop, len(one))):
        if (part.stop - part.start) / one.sample_rate >= SHORTEST:
            yield one.slice(part.start, part.stop)


def _stretch(rows: NDArray[np.uint64], before: NDArray[np.uint64]) -> slice | None:
    """Stretch of some rows that others contain too; None where there is none."""
    same = np.isin(rows, before)
    places = np.flatnonzero(same)
    if len(places) < max(FEWEST, SAME_ROWS * len(rows)):
        return None
    stretch = slice(int(places[0]), int(places[-1]) + 1)
    return stretch if same[stretch].mean() > SOLID else None


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


def _name(one: Recording | Poses, place: int) -> str:
    """Name of the file of a recording, or its number."""
    return one.source.name if one.source else f"recording {place + 1}"


def _counted_once(name: str, share: float) -> Finding:
    what = f"{name} was passed twice" if share == 1.0 else f"{share:.0%} of {name} are data of an earlier recording"
    return Finding(
        "repeated-data", "", share, "1", "warning", f"{what}: counted once", "pass every sample once", recording=name
    )
