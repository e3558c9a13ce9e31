"""Checks of several groups of recordings: do they fit together?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, product

import numpy as np

from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.torques import Term, nonlinear_settings

from .recording_summary import RecordingSummary

SAME = 1e-9
"""Regressors of legs of one design differ by less than this part of the largest entry."""


def refuse_nonlinear_terms(legs: Mapping[str, Leg], terms: Sequence[Term]) -> None:
    """Refuse terms whose torque is not linear in all parameters where there are several groups.

    Args:
        legs: Leg of each group, by its name.
        terms: The terms.

    Raises:
        ExoidError: Names the nonlinear parameters and terms.
    """
    leg = next(iter(legs.values()))
    free = [setting.name for setting in nonlinear_settings(terms, leg.joint_names, leg.joint_labels)]
    loaded = [type(term).__name__ for term in terms if term.loaded]
    if free or loaded:
        raise ExoidError(
            f"{', '.join((*free, *loaded))}: several groups are fitted together only where torque is linear in all "
            "parameters",
            remedy="give settings numbers, such as those that exoid.identify finds, and leave LoadFriction out",
        )


def refuse_other_designs(legs: Mapping[str, Leg]) -> None:
    """Refuse legs whose rigid-body parameters do not mean the same.

    Args:
        legs: Leg of each group, by its name.

    Raises:
        ExoidError: Names the groups.
    """
    (first, leg), *others = legs.items()
    motion = np.random.default_rng(0).standard_normal((3, 10, len(leg.joint_names)))
    expected = leg.regressor(*motion)
    for other, of_other in others:
        found = of_other.regressor(*motion)
        if np.abs(found - expected).max() > SAME * np.abs(expected).max():
            raise ExoidError(
                f"legs of {first} and {other} are not of one design: lengths or axes differ, so that their "
                "rigid-body parameters do not mean the same",
                remedy="identify them one by one",
            )


def refuse_same_recordings(summaries: Mapping[str, Sequence[RecordingSummary]]) -> None:
    """Refuse a recording that is in two groups, and would count twice.

    Args:
        summaries: Summaries of the recordings of each group, by its name.

    Raises:
        ExoidError: Names recording and groups.
    """
    for (one, first), (other, second) in combinations(summaries.items(), 2):
        for a, b in product(first, second):
            if a.evidence == b.evidence and np.array_equal(a.mean, b.mean):  # of one file there may be several parts
                name = f"recording {a.source}" if a.source else "the same recording"
                raise ExoidError(f"{name} is in {one} and in {other}", remedy="put it into one of them")
