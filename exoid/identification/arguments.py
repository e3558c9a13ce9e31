"""Arguments of an identification, checked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike

from exoid.errors import ExoidError
from exoid.signals import Cluster, Poses, Preparation, Recording, Recordings, ZeroPhase, preparation_by_name
from exoid.signals.cutoff import cutoff_from
from exoid.torques import DEFAULT_TERMS, Term

from .group_rows import Data
from .recording_summary import RecordingSummary

NOISES = ("correlated", "white")


def check_noise(noise: str) -> None:
    """Check the name of what a covariance assumes."""
    if noise not in NOISES:
        raise ExoidError(f"no noise {noise!r}", remedy=f"use one of {', '.join(NOISES)}")


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


def check_terms(given: Sequence[Term] | None) -> tuple[Term, ...]:
    """Check that terms are terms, not names of terms."""
    if given is None:
        return DEFAULT_TERMS
    terms = (given,) if isinstance(given, (Term, str)) else tuple(given)
    wrong = [item for item in terms if not isinstance(item, Term)]
    if wrong:
        raise ExoidError(f"{wrong[0]!r} is no term", remedy="pass terms such as (exoid.Coulomb(), exoid.Viscous())")
    return terms
