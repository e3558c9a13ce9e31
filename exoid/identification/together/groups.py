"""Groups of recordings that belong together: those of a leg, or of a session."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid.errors import ExoidError
from exoid.identification.identify import check_recordings
from exoid.identification.recording_summary import SMALLEST_MOTION, Survey, refuse_still_joints
from exoid.leg import Leg
from exoid.signals import Cluster, Poses, Recording
from exoid.signals import Recordings as OnDisk
from exoid.signals.recordings import Stored
from exoid.torques import TorqueModel

Recordings = Recording | Poses | Iterable[Recording | Poses]
"""One recording or several."""

SAME = 1e-9
"""Regressors of legs of one design differ by less than this part of the largest entry."""


class Group(NamedTuple):
    """Recordings of one leg that have parameters of their own.

    Attributes:
        name: Of the group.
        leg: The leg.
        data: Its recordings and poses.
    """

    name: str
    leg: Leg
    data: Sequence[Recording | Poses]


def make_groups(
    legs: Leg | Mapping[str, Leg], recordings: Mapping[str, Recordings] | Sequence[Recording | Poses]
) -> tuple[Group, ...]:
    """Bring legs and recordings together by the names of the groups; a recording without a name has a number.

    Raises:
        ExoidError: Names of legs and of recordings differ, two groups have the same name, or recordings are elsewhere.
    """
    given = recordings.values() if isinstance(recordings, Mapping) else (recordings,)
    if any(isinstance(data, Cluster) for data in given):
        raise ExoidError("recordings on a cluster are for one leg alone", remedy="pass exoid.signals.Recordings")
    named = recordings if isinstance(recordings, Mapping) else _by_source(check_recordings(recordings))
    if not named:
        raise ExoidError("no recordings", remedy='pass groups such as {"left": [...], "right": [...]}')
    if isinstance(legs, Mapping) and set(legs) != set(named):
        raise ExoidError(
            f"legs are of {', '.join(legs)}, recordings of {', '.join(named)}", remedy="use the same names for both"
        )
    if len({str(name) for name in named}) < len(named):
        raise ExoidError(f"two groups have the same name: {', '.join(map(str, named))}", remedy="name them otherwise")
    groups = []
    for name, data in named.items():
        with within(name):
            leg = legs[name] if isinstance(legs, Mapping) else legs
            groups.append(Group(str(name), leg, check_recordings(data)))
    return tuple(groups)


@contextmanager
def within(group: str) -> Iterator[None]:
    """Say in errors which group they are about."""
    try:
        yield
    except ExoidError as error:
        where = f"{group}, {error.where}".rstrip(", ")
        raise ExoidError(error.what, where=where, remedy=error.remedy) from error


def refuse_other_designs(groups: Sequence[Group]) -> None:
    """Refuse legs whose rigid-body parameters do not mean the same.

    Raises:
        ExoidError: Names the groups.
    """
    first, *others = groups
    motion = np.random.default_rng(0).standard_normal((3, 10, len(first.leg.joint_names)))
    expected = first.leg.regressor(*motion)
    for other in others:
        found = other.leg.regressor(*motion)
        if np.abs(found - expected).max() > SAME * np.abs(expected).max():
            raise ExoidError(
                f"legs of {first.name} and {other.name} are not of one design: lengths or axes differ, so that their "
                "rigid-body parameters do not mean the same",
                remedy="identify them one by one",
            )


def refuse_still_groups(
    surveys: Mapping[str, Sequence[Survey]],
    models: Sequence[TorqueModel],
    shared: Sequence[str],
    assumed: Sequence[Sequence[str]],
) -> None:
    """Refuse joints that stand still in all groups, and in one of them where that leaves own parameters unknown.

    Args:
        surveys: Of the recordings of each group, by its name.
        models: Of each.
        shared: Parameters that another group may tell.
        assumed: Parameters of each that are known or have a prior.

    Raises:
        ExoidError: Names group and joint.
    """
    moves = np.any([_moving(of_group) for of_group in surveys.values()], axis=0)
    unseen = {name for joint in np.flatnonzero(~moves) for name in models[0].own_parameters(int(joint))}
    told = [name for name in shared if name not in unseen]
    for (group, of_group), model, known in zip(surveys.items(), models, assumed, strict=True):
        with within(group):
            refuse_still_joints(model, of_group, (*known, *told))


def _moving(surveys: Sequence[Survey]) -> NDArray[np.bool_]:
    """Which joints move in the recordings of a group, (n,)."""
    lowest, highest = (np.array([getattr(one, side) for one in surveys]) for side in ("lowest", "highest"))
    return np.asarray(highest.max(axis=0) - lowest.min(axis=0) >= SMALLEST_MOTION)


def refuse_same_recordings(surveys: Mapping[str, Sequence[Survey]]) -> None:
    """Refuse a recording that is in two groups, and would count twice.

    Raises:
        ExoidError: Names recording and groups.
    """
    for (one, first), (other, second) in combinations(surveys.items(), 2):
        for a, b in product(first, second):
            if a.evidence == b.evidence and np.array_equal(a.mean, b.mean):  # of one file there may be several parts
                name = f"recording {a.source}" if a.source else "the same recording"
                raise ExoidError(f"{name} is in {one} and in {other}", remedy="put it into one of them")


def _by_source(recordings: Sequence[Recording | Poses]) -> dict[str, Sequence[Recording | Poses]]:
    """Make a group of each recording, named after its file."""
    named: dict[str, Sequence[Recording | Poses]] = {}
    for index in range(len(recordings)):
        name = _file_name(recordings, index) or str(index + 1)
        if name in named:
            raise ExoidError(f"two recordings are called {name}", remedy='name them: {"monday": a, "tuesday": b}')
        named[name] = recordings[index : index + 1]
    return named


def _file_name(recordings: Sequence[Recording | Poses], index: int) -> str:
    """Name of the file of a recording, without reading it if it is on disk; "" for one made in memory."""
    if isinstance(recordings, OnDisk):
        item = recordings.items[index]
        if isinstance(item, Stored):
            return item.path.name
    source = recordings[index].source
    return "" if source is None else source.name
