"""Recordings that are passed twice, or that overlap: each sample counts once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from exoid._typing import BoolArray
from exoid.estimate.finding import Finding
from exoid.regression.rows import for_leg
from exoid.signals import Poses, Recording, Recordings
from exoid.torques import TorqueModel

from .findings import overlaps
from .group_rows import Data, Group
from .recording_summary import RecordingSummary, summarize

FEWEST_SAMPLES = 10
"""A recording of which fewer samples are left is left out."""


class Once(NamedTuple):
    """Groups of recordings without samples that are passed twice."""

    groups: tuple[Group, ...]  # the groups
    summaries: dict[str, list[RecordingSummary]]  # summaries of their recordings, by the name of the group
    findings: tuple[tuple[Finding, ...], ...]  # what was left out of each group


def counted_once(
    groups: Sequence[Group], models: Mapping[str, TorqueModel], summaries: Mapping[str, Sequence[RecordingSummary]]
) -> Once:
    """Leave out samples that are passed twice in a group."""
    # Copies of a recording are found in memory and on disk, under whatever name. Recordings in memory that
    # overlap get a mask: their shared samples count in the first one only.
    kept_groups, kept_summaries, findings = [], {}, []
    for group in groups:
        data, of_group = group.data, list(summaries[group.name])
        found: list[Finding] = []
        if len(of_group) > 1:
            data, of_group, found = _without_copies(data, of_group)
            if not isinstance(data, Recordings):
                data, of_group, overlapping = _without_overlaps(models[group.name], data, of_group)
                found += overlapping
        kept_groups.append(group if not found else group._replace(data=data))
        kept_summaries[group.name] = of_group
        findings.append(tuple(found))
    return Once(tuple(kept_groups), kept_summaries, tuple(findings))


class _Kept(NamedTuple):
    """Recordings that count, their summaries, and findings about the others."""

    data: Sequence[Recording | Poses]
    summaries: list[RecordingSummary]
    findings: list[Finding]


def _without_copies(data: Sequence[Recording | Poses], summaries: Sequence[RecordingSummary]) -> _Kept:
    """Leave out recordings that are passed twice."""
    first: dict[tuple[object, ...], int] = {}
    for place, summary in enumerate(summaries):
        first.setdefault(_content(summary), place)
    kept = sorted(first.values())
    findings = [
        _finding(1.0, f"{_name(summaries, k)} was passed twice: counted once", summaries[k].source)
        for k in range(len(summaries))
        if k not in set(kept)
    ]
    return _Kept(_chosen(data, kept) if findings else data, [summaries[k] for k in kept], findings)


def _without_overlaps(
    model: TorqueModel, data: Sequence[Recording | Poses], summaries: Sequence[RecordingSummary]
) -> _Kept:
    """Let samples that two recordings share count in the first one only."""
    moving = [k for k, one in enumerate(data) if isinstance(one, Recording)]
    recordings = [for_leg(model, one) for one in data if isinstance(one, Recording)]
    masks: dict[int, BoolArray] = {}
    findings: list[Finding] = []
    for overlap in overlaps(recordings):
        first, second = moving[overlap.first], moving[overlap.second]
        before = recordings[overlap.second].mask
        once = ~overlap.again if before is None else before & ~overlap.again
        masks[second] = masks.get(second, once) & once
        share = f"share {overlap.share:.0%} of their samples: counted once"
        names = f"{_name(summaries, first)} and {_name(summaries, second)}"
        findings.append(_finding(overlap.share, f"{names} {share}", summaries[second].source))
    kept_data, kept = [], []
    for k, (one, summary) in enumerate(zip(data, summaries, strict=True)):
        if k not in masks:
            kept_data.append(one)
            kept.append(summary)
        elif isinstance(one, Recording) and np.count_nonzero(masks[k]) >= FEWEST_SAMPLES:
            rest = replace(one, mask=masks[k])
            kept_data.append(rest)
            power = summary.acceleration_power  # that of the angles of the whole recording
            kept.append(summarize(model, rest, for_cutoff=False)._replace(acceleration_power=power))
    return _Kept(kept_data if findings else data, kept, findings)


def _content(summary: RecordingSummary) -> tuple[object, ...]:
    """What two recordings share only if they are the same; of one file there may be several parts."""
    evidence = summary.evidence
    angles = (summary.lowest, summary.highest, summary.mean)
    return (evidence.sha256, evidence.samples, evidence.segments, *(array.tobytes() for array in angles))


def _chosen(data: Data, places: Sequence[int]) -> Sequence[Recording | Poses]:
    """Take some recordings; those on disk are not read."""
    if isinstance(data, Recordings):
        return replace(data, items=tuple(data.items[k] for k in places))
    return [data[k] for k in places]


def _name(summaries: Sequence[RecordingSummary], place: int) -> str:
    return summaries[place].source or f"recording {place + 1}"


def _finding(share: float, message: str, source: str) -> Finding:
    """Say which samples were passed twice."""
    return Finding("repeated-data", "", share, "1", "warning", message, "pass every sample once", recording=source)
