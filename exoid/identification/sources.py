"""Recordings in memory, on disk, or on a cluster: what holds for all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from exoid.signals import Cluster, Poses, Recording, Recordings

T = TypeVar("T")

Measured = Recording | Poses


def go_over(data: Sequence[Measured] | Cluster, work: Callable[[Measured], T]) -> list[T]:
    """Do work on each recording, one after the other, or where they are."""
    return data.map(work) if isinstance(data, Cluster) else [work(each) for each in data]


def at_rest(data: Sequence[Measured] | Cluster, index: int) -> bool:
    """Say whether one of them is poses, without reading it; those on a cluster are not."""
    if isinstance(data, Cluster):
        return False
    return data.at_rest(index) if isinstance(data, Recordings) else isinstance(data[index], Poses)
