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
    kept: list[Recording | Poses] = []
    findings = []
    for k, one in enumerate(data):
        parts = [one]
        for before in data[:k]:
            parts = [rest for part in parts for rest in _without(part, before)]
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
    rows = [_distinct(_hashes(one)) for one in recordings]
    for first, second in combinations(range(len(recordings)), 2):
        share = len(np.intersect1d(rows[first], rows[second])) / max(1, min(len(rows[first]), len(rows[second])))
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


def _without(one: Recording | Poses, before: Recording | Poses) -> Iterator[Recording | Poses]:
    """Cut out of a recording what an earlier one contains."""
    if isinstance(one, Poses) or isinstance(before, Poses):
        yield one
        return
    stretch = _shared(_hashes(one), _hashes(before))
    if stretch is None:
        yield one
        return
    for part in (slice(0, stretch.start), slice(stretch.stop, len(one))):
        if (part.stop - part.start) / one.sample_rate >= SHORTEST:
            yield one.slice(part.start, part.stop)


def _shared(rows: NDArray[np.uint64], before: NDArray[np.uint64]) -> slice | None:
    """Stretch of some rows that others contain too; None where there is none."""
    same = np.isin(rows, np.intersect1d(_distinct(rows), _distinct(before)))
    places = np.flatnonzero(same)
    if len(places) < max(FEWEST, SAME_ROWS * min(len(rows), len(before))):
        return None
    stretch = slice(int(places[0]), int(places[-1]) + 1)
    return stretch if same[stretch].mean() > SOLID else None


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
