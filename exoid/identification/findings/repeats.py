"""Data that occur twice: the same log passed again, and parts of one log that overlap. Each sample counts once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray
from exoid.estimate.finding import Finding
from exoid.identification.group_rows import Data, Group
from exoid.identification.recording_summary import RecordingSummary, summarize
from exoid.signals import Poses, Recording, Recordings


def _without_copies(group: Group) -> Group:
    """Leave out recordings that are passed twice, under whatever name; those on disk are not read."""
    summaries, data = group.summaries, group.data
    first: dict[tuple[object, ...], int] = {}
    for place, one in enumerate(summaries):
        # what two recordings share only if they are the same; of one file there may be several parts
        angles = (array.tobytes() for array in (one.lowest, one.highest, one.mean))
        first.setdefault((one.evidence.sha256, one.evidence.samples, one.evidence.segments, *angles), place)
    kept, twice = sorted(first.values()), "was passed twice: counted once"
    again = [k for k in range(len(summaries)) if k not in set(kept)]
    findings = [_finding(1.0, f"{_name(summaries, k)} {twice}", summaries[k].source) for k in again]
    rest: Data
    if isinstance(data, Recordings):
        rest = replace(data, items=tuple(data.items[k] for k in kept))
    else:
        rest = [data[k] for k in kept]
    return replace(group, data=rest, summaries=[summaries[k] for k in kept], findings=(*group.findings, *findings))


def counted_once(group: Group) -> Group:
    """Let samples that are passed twice count once: of recordings in memory that overlap, in the first one only."""
    group = _without_copies(group)
    if isinstance(group.data, Recordings):
        return group
    model, summaries, findings = group.model, group.summaries, list(group.findings)
    moving = [k for k, one in enumerate(group.data) if isinstance(one, Recording)]
    recordings = [model.select(one) for one in group.data if isinstance(one, Recording)]
    masks: dict[int, BoolArray] = {}
    for one, other, share, again in overlaps(recordings):
        first, second = moving[one], moving[other]
        before = recordings[other].mask
        once = ~again if before is None else before & ~again
        masks[second] = masks.get(second, once) & once
        names = f"{_name(summaries, first)} and {_name(summaries, second)}"
        message = f"{names} share {share:.0%} of their samples: counted once"
        findings.append(_finding(share, message, summaries[second].source))
    data: list[Recording | Poses] = []
    kept = []
    for k, (log, summary) in enumerate(zip(group.data, summaries, strict=True)):
        if k not in masks:
            data.append(log)
            kept.append(summary)
        elif isinstance(log, Recording) and np.count_nonzero(masks[k]) >= 10:  # fewer samples are left out
            data.append(replace(log, mask=masks[k]))
            power = summary.acceleration_power  # that of the angles of the whole recording
            kept.append(summarize(model, data[-1], for_cutoff=False)._replace(acceleration_power=power))
    return replace(group, data=data, summaries=kept, findings=tuple(findings))


def _name(summaries: Sequence[RecordingSummary], place: int) -> str:
    return summaries[place].source or f"recording {place + 1}"


def _finding(share: float, message: str, source: str = "", parameters: Sequence[str] = ()) -> Finding:
    """Say which samples were passed twice."""
    remedy = "pass every sample once"
    return Finding("repeated-data", "", share, "1", "warning", message, remedy, None, tuple(parameters), source)


def repeated_data(recordings: Sequence[Recording], parameters: Sequence[str]) -> Iterator[Finding]:
    """Report recordings that contain the same samples, where these count twice."""
    for first, second, share, _ in overlaps(recordings):
        both = " and ".join(recordings[k].file_name or str(k + 1) for k in (first, second))
        message = f"{both} share {share:.0%} of their samples, which count twice: intervals are too narrow"
        yield _finding(share, message, parameters=parameters)


def overlaps(recordings: Sequence[Recording]) -> Iterator[tuple[int, int, float, BoolArray]]:
    """Find pairs that share over 5 % of the samples that count: places, the share, a mask of those of the later one."""
    if len(recordings) < 2 or sum(map(len, recordings)) > 1_000_000:  # a search of more would take seconds
        return
    hashes = [_hashes(one) for one in recordings]
    counted = [own if one.mask is None else own[one.mask] for own, one in zip(hashes, recordings, strict=True)]
    # a leg at rest may give the same row at any time: only rows that occur once in a recording are compared
    distinct = [rows[counts == 1] for rows, counts in (np.unique(own, return_counts=True) for own in counted)]
    values, counts = np.unique(np.concatenate(distinct), return_counts=True)
    rows = [np.intersect1d(own, values[counts > 1]) for own in distinct]
    for first, second in combinations([k for k, own in enumerate(rows) if len(own)], 2):
        shortest = max(1, min(len(counted[first]), len(counted[second])))
        share = len(np.intersect1d(rows[first], rows[second])) / shortest
        if share > 0.05:
            yield first, second, share, np.isin(hashes[second], counted[first])


def _hashes(recording: Recording) -> NDArray[np.uint64]:
    """Hash of the angles and torques of each sample, whatever its time, (N,)."""
    columns = [recording.q] if recording.tau is None else [recording.q, recording.tau]
    rows = np.ascontiguousarray(np.hstack(columns), dtype=np.float64) + 0.0  # no negative zero
    factors = np.random.default_rng(0).integers(1, 2**63, rows.shape[1], dtype=np.uint64) | np.uint64(1)
    bits = rows.view(np.uint64)
    mixed = (bits ^ (bits >> np.uint64(29))) * factors
    return np.asarray((mixed ^ (mixed >> np.uint64(32))).sum(axis=1, dtype=np.uint64))
