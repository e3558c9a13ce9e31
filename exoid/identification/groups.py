"""Groups of recordings that belong together: those of a leg, or of a session."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.regression.parameters import ParameterLayout, PriorKnowledge
from exoid.signals import Cluster, Poses, Preparation, Recording, Recordings, ZeroPhase, preparation_by_name
from exoid.signals.default_preparation import cutoff_from
from exoid.signals.recordings import RecordingFile
from exoid.torques import TorqueModel

from .group_checks import refuse_other_designs, refuse_same_recordings
from .group_rows import Data, map_recordings
from .recording_summary import SMALLEST_MOTION, RecordingSummary, refuse_dead_torques, refuse_still_joints, summarize

Measured = Recording | Poses | Iterable[Recording | Poses]
"""One recording or several."""


@contextmanager
def within(part: str) -> Iterator[None]:
    """Name the part of the input, such as a group of recordings, in errors that are raised inside.

    Args:
        part: Its name; "" adds nothing.

    Raises:
        ExoidError: The error that was raised inside, with the name.
    """
    try:
        yield
    except ExoidError as error:
        where = ", ".join(filter(None, (part, error.where)))
        raise ExoidError(error.what, where=where, remedy=error.remedy) from error


class Group(NamedTuple):
    """Recordings of one leg, or of one session.

    Attributes:
        name: Name of the group; "" where there is only one.
        leg: The leg.
        data: Its recordings and poses.
        preparation: Filter and differentiation; None while it is not chosen.
    """

    name: str
    leg: Leg
    data: Data
    preparation: Preparation | None = None

    @property
    def chosen_preparation(self) -> Preparation:
        """How the recordings become rows, chosen by :func:`prepare_groups`."""
        assert self.preparation is not None
        return self.preparation


def make_groups(
    legs: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured] | Cluster,
    own: str | Sequence[str] | None,
) -> tuple[Group, ...]:
    """Bring legs and recordings together by the names of the groups; a recording without a name has a number.

    Args:
        legs: The leg, or one for each group.
        recordings: Recordings by the name of the group; without names, each is a group if ``own`` is given.
        own: Parameters that each group has of its own; None for one group, unless recordings have names.

    Returns:
        The groups; one without a name where neither names nor ``own`` are given.

    Raises:
        ExoidError: Names of legs and of recordings differ, two groups have the same name, or recordings are elsewhere.
    """
    if own is None and not isinstance(recordings, Mapping):
        if isinstance(legs, Mapping):
            raise ExoidError("legs have names, recordings have none", remedy='name both: {"left": leg}, {"left": log}')
        return (Group("", legs, check_recordings(recordings)),)
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


def refuse_still_groups(
    summaries: Mapping[str, Sequence[RecordingSummary]],
    models: Sequence[TorqueModel],
    shared: Sequence[str],
    known: Sequence[Sequence[str]],
) -> None:
    """Refuse joints that stand still in all groups, and in one of them where that leaves own parameters unknown.

    Args:
        summaries: Summaries of the recordings of each group, by its name.
        models: Torque model of each group.
        shared: Parameters that another group may determine.
        known: Parameters of each group that are known or have a prior.

    Raises:
        ExoidError: Names group and joint.
    """
    moves = np.any([_moving(of_group) for of_group in summaries.values()], axis=0)
    unseen = {name for joint in np.flatnonzero(~moves) for name in models[0].own_parameters(int(joint))}
    told = [name for name in shared if name not in unseen]
    for (group, of_group), model, of_model in zip(summaries.items(), models, known, strict=True):
        with within(group):
            refuse_still_joints(model, of_group, (*of_model, *told))


def _moving(summaries: Sequence[RecordingSummary]) -> NDArray[np.bool_]:
    """Which joints move in the recordings of a group, (n,)."""
    lowest, highest = (np.array([getattr(one, side) for one in summaries]) for side in ("lowest", "highest"))
    return np.asarray(highest.max(axis=0) - lowest.min(axis=0) >= SMALLEST_MOTION)


def _by_source(recordings: Data) -> dict[str, Sequence[Recording | Poses]]:
    """Make a group of each recording, named after its file."""
    named: dict[str, Sequence[Recording | Poses]] = {}
    assert not isinstance(recordings, Cluster)
    for index in range(len(recordings)):
        name = _file_name(recordings, index) or str(index + 1)
        if name in named:
            raise ExoidError(f"two recordings are called {name}", remedy='name them: {"monday": a, "tuesday": b}')
        named[name] = recordings[index : index + 1]
    return named


def _file_name(recordings: Sequence[Recording | Poses], index: int) -> str:
    """Name of the file of a recording, without reading it if it is on disk; "" for one made in memory."""
    if isinstance(recordings, Recordings):
        item = recordings.items[index]
        if isinstance(item, RecordingFile):
            return item.path.name
    source = recordings[index].source
    return "" if source is None else source.name


def own_parameters(models: Mapping[str, TorqueModel], own: str | Sequence[str] | None) -> tuple[str, ...]:
    """Look up the names of the parameters that each group has of its own.

    Args:
        models: Torque model of each group, by its name.
        own: Symbols such as "c0", or names such as "c0_hip" or "J1"; None for all but those of the rigid bodies.

    Returns:
        Names, in the model's order; none for one group without a name.

    Raises:
        ExoidError: Names of the groups' parameters differ, or there is no such symbol or name.
    """
    if own is None and list(models) == [""]:
        return ()
    _refuse_other_names(models)
    model = next(iter(models.values()))
    rigid = model.leg.parameter_names
    if own is None:
        return tuple(name for name in model.names if name not in rigid)
    asked = (own,) if isinstance(own, str) else tuple(own)
    symbols: dict[str, set[str]] = {}
    for block in model.blocks:
        for symbol, name in zip(block.term.symbols, block.names, strict=True):
            symbols.setdefault(symbol, set()).add(name)
    for name in asked:
        if name not in symbols and name not in model.every_name:
            known = ", ".join((*symbols, *model.every_name))
            raise ExoidError(f"no parameter {name!r} to be each group's own", remedy=f"name some of {known}")
    for regrouped in model.regrouped:
        if regrouped.name in asked:
            raise ExoidError(f"{regrouped}", remedy=f"name {' and '.join(regrouped.into)} as own instead")
    wanted = {name for given in asked for name in symbols.get(given, {given})}
    return tuple(name for name in model.names if name in wanted)


def _refuse_other_names(models: Mapping[str, TorqueModel]) -> None:
    """Refuse groups whose models do not have the same parameters."""
    (first, model), *others = models.items()
    for group, other in others:
        if other.names != model.names or other.units != model.units:
            raise ExoidError(
                f"parameters of {first} are {', '.join(model.names)}, those of {group} {', '.join(other.names)}",
                remedy="identify legs of one design, with the same joints, together",
            )


def summarize_groups(
    groups: Sequence[Group],
    models: Mapping[str, TorqueModel],
    own: Sequence[str],
    knowledge: PriorKnowledge,
    *,
    for_cutoff: bool,
) -> dict[str, list[RecordingSummary]]:
    """Look through all recordings once, and refuse groups that nothing can be identified from.

    Args:
        groups: The groups.
        models: Torque model of each, by its name.
        own: Names of parameters that each group has of its own.
        knowledge: Known parameters, priors and signs.
        for_cutoff: Whether to compare noise and motion of the angles.

    Returns:
        Summaries of the recordings of each group, by its name.

    Raises:
        ExoidError: Legs of groups differ, what is known does not fit them, a recording is in two groups, or a joint
            stands still.
    """
    model = next(iter(models.values()))
    if len(groups) > 1 and not set(model.leg.parameter_names) <= set(own):
        refuse_other_designs({group.name: group.leg for group in groups})
    layout = ParameterLayout.of(list(models), model.names, model.units, own)
    knowledge.check_regrouped(model.regrouped)
    spread = layout.spread(knowledge)
    summaries = {}
    for group in groups:
        with within(group.name):
            summaries[group.name] = map_recordings(
                group.data, partial(summarize, models[group.name], for_cutoff=for_cutoff)
            )
    if len(groups) > 1:
        refuse_same_recordings(summaries)
    known = [layout.known_by(index, spread).names for index in range(len(groups))]
    refuse_still_groups(summaries, list(models.values()), layout.names[: layout.shared], known)
    return summaries


def prepare_groups(
    groups: Sequence[Group],
    models: Mapping[str, TorqueModel],
    summaries: Mapping[str, Sequence[RecordingSummary]],
    preparation: Preparation | str | None,
    cutoff: float | None,
) -> tuple[Group, ...]:
    """Choose how the recordings of each group become rows.

    Args:
        groups: The groups.
        models: Torque model of each, by its name.
        summaries: Summaries of its recordings, by its name.
        preparation: The preparation that was asked for; None for the parallel filter.
        cutoff: Cut-off frequency that was asked for [Hz]; None to choose one for each group.

    Returns:
        The groups with their preparation.

    Raises:
        ExoidError: The torque of a joint never changes, or there is no such preparation.
    """
    prepared = []
    for group in groups:
        with within(group.name):
            chosen = choose_preparation(summaries[group.name], preparation, cutoff)
            refuse_dead_torques(models[group.name], summaries[group.name])
        prepared.append(group._replace(preparation=chosen))
    return tuple(prepared)


def choose_preparation(
    summaries: Sequence[RecordingSummary], given: Preparation | str | None, cutoff: float | None
) -> Preparation:
    """Take the preparation that was given, or the parallel filter with a cut-off given or chosen from recordings."""
    if isinstance(given, str):
        return preparation_by_name(given)
    if given is not None:
        return given
    return ZeroPhase(
        cutoff_from([one.acceleration_power for one in summaries if one.acceleration_power])
        if cutoff is None
        else cutoff
    )


def check_recordings(given: Recording | Poses | Iterable[Recording | Poses] | Cluster) -> Data:
    """Check that there is at least one recording, and nothing else; those on disk or on a cluster stay there."""
    if isinstance(given, Cluster):
        return given
    if isinstance(given, Recordings) and len(given):
        return given
    several = [given] if isinstance(given, (Recording, Poses, str, PathLike)) else list(given)
    wrong = [item for item in several if not isinstance(item, (Recording, Poses, Recordings))]
    if wrong or not several:
        what = f"{wrong[0]!r} is no recording" if wrong else "no recordings"
        raise ExoidError(what, remedy='pass at least one, such as Recording.from_csv("log.csv")')
    if any(isinstance(item, Recordings) for item in several):
        items = (item.items if isinstance(item, Recordings) else (item,) for item in several)
        return Recordings(tuple(each for of_item in items for each in of_item))
    return several
