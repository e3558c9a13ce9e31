"""Recordings that are passed twice: they count once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from exoid.findings import Finding
from exoid.signals import Cluster, Recordings

from .group_rows import Data, Group
from .recording_summary import RecordingSummary


class Once(NamedTuple):
    """Groups of recordings without those that are passed twice.

    Attributes:
        groups: The groups.
        summaries: Summaries of their recordings, by the name of the group.
        findings: What was left out of each group.
    """

    groups: tuple[Group, ...]
    summaries: dict[str, list[RecordingSummary]]
    findings: tuple[tuple[Finding, ...], ...]


def counted_once(groups: Sequence[Group], summaries: Mapping[str, Sequence[RecordingSummary]]) -> Once:
    """Leave out recordings that are passed twice, whether in memory or on disk and under whatever name.

    Args:
        groups: Groups of recordings; those on a cluster stay as they are.
        summaries: Summaries of their recordings, by the name of the group.

    Returns:
        What remains.
    """
    kept_groups, kept_summaries, findings = [], {}, []
    for group in groups:
        of_group = list(summaries[group.name])
        first: dict[tuple[object, ...], int] = {}
        for place, summary in enumerate(of_group):
            first.setdefault(_content(summary), place)
        kept = sorted(first.values())
        again = [k for k in range(len(of_group)) if k not in set(kept)]
        if again and not isinstance(group.data, Cluster):
            group = group._replace(data=_chosen(group.data, kept))  # noqa: PLW2901
            of_group = [of_group[k] for k in kept]
            findings.append(tuple(_finding(summaries[group.name][k].source, k) for k in again))
        else:
            findings.append(())
        kept_groups.append(group)
        kept_summaries[group.name] = of_group
    return Once(tuple(kept_groups), kept_summaries, tuple(findings))


def _content(summary: RecordingSummary) -> tuple[object, ...]:
    """What two recordings share only if they are the same; of one file there may be several parts."""
    evidence = summary.evidence
    angles = (summary.lowest, summary.highest, summary.mean)
    return (evidence.sha256, evidence.samples, evidence.segments, *(array.tobytes() for array in angles))


def _chosen(data: Data, places: Sequence[int]) -> Data:
    """Take some recordings; those on disk are not read."""
    assert not isinstance(data, Cluster)
    if isinstance(data, Recordings):
        return replace(data, items=tuple(data.items[k] for k in places))
    return [data[k] for k in places]


def _finding(source: str, place: int) -> Finding:
    """Say that a recording was passed twice."""
    name = source or f"recording {place + 1}"
    return Finding(
        "repeated-data",
        "",
        1.0,
        "1",
        "warning",
        f"{name} was passed twice: counted once",
        "pass every sample once",
        recording=source,
    )
