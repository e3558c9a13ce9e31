"""Joints that move and whose torque was not measured: they give no rows, and terms act on the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from exoid.errors import NotIdentifiableError, NotSupportedError
from exoid.estimate.finding import Finding
from exoid.leg.leg import Leg
from exoid.torques import CoordinateTerm, Term

from .estimators import Estimator
from .estimators.by_name import name_of
from .group_rows import Group
from .problem import Problem
from .recording_summary import unmeasured_joints


def terms_where_measured(problem: Problem, estimator: Estimator, unmeasured: Sequence[str]) -> tuple[Term, ...]:
    """Let terms of all joints act only on joints whose torque was measured, or whose parameters are known."""
    # Friction of a joint leaves no trace in the torques of other joints.
    if getattr(estimator, "fits_samples", False):
        raise NotSupportedError(
            f"{name_of(estimator)} fits the torque of every joint, and that of some was not measured",
            remedy="use wls, huber or ols",
        )
    leg, terms = problem.groups[0].model.leg, problem.terms
    known = (*problem.given.known_names, *problem.given.prior.values)
    kept = []
    for term in terms:
        if isinstance(term, CoordinateTerm):
            kept.append(_coupled_where_measured(term, leg, unmeasured, known))
            continue
        told = {joint for joint in unmeasured if {f"{symbol}_{joint}" for symbol in term.symbols} <= set(known)}
        without = [joint for joint in unmeasured if joint not in told]
        if term.joints is None:
            joints = tuple(joint for joint in leg.joint_labels if joint not in without)
            kept += [replace(term, joints=joints)] if joints else []
            continue
        named = {leg.joint_labels[k] for k in term.joint_indices(leg.joint_names, leg.joint_labels)}
        wrong = [joint for joint in without if joint in named]
        if wrong:
            names = [f"{symbol}_{joint}" for joint in wrong for symbol in term.symbols]
            raise NotIdentifiableError(
                f"{', '.join(names)} left no trace: the torque of {', '.join(wrong)} was not measured",
                remedy=f"leave {', '.join(wrong)} out of the joints of {type(term).__name__}, or say what is known of "
                "these parameters (known=)",
                parameters=tuple(names),
            )
        kept.append(term)
    return tuple(kept)


def _coupled_where_measured(term: CoordinateTerm, leg: Leg, unmeasured: Sequence[str], known: Sequence[str]) -> Term:
    """Refuse a coupling none of whose joints has a torque; one joint with torque shows its parameters."""
    (places,) = term.places(leg.joint_names, leg.joint_labels)
    labels = [leg.joint_labels[place] for place in places]
    names = [f"{symbol}_{'_'.join(labels)}" for symbol in term.symbols]
    if set(labels) <= set(unmeasured) and not set(names) <= set(known):
        raise NotIdentifiableError(
            f"{', '.join(names)} left no trace: the torque of {', '.join(labels)} was not measured",
            remedy=f"leave {type(term).__name__} out, or say what is known of these parameters (known=)",
            parameters=tuple(names),
        )
    return term


def unmeasured_finding(group: Group) -> tuple[Finding, ...]:
    """Say which joints of a group have no torque."""
    summaries, names = group.summaries, group.model.leg.joint_names
    nowhere, found = unmeasured_joints(names, summaries), list(group.findings)
    for place, joint in enumerate(names):
        torques = [one.torques for one in summaries if one.torques is not None]
        without = sum(not of_one.measured[place] for of_one in torques)
        if not without:
            continue
        message = (
            f"the torque of {joint} was not measured: it moves without rows, and its friction is not identified"
            if joint in nowhere
            else f"the torque of {joint} was not measured in {without} of {len(torques)} recordings, which have no "
            "rows of it"
        )
        remedy = "record it, or declare the joint passive if it has no actuator (passive=, --passive)"
        found.append(Finding("unmeasured-torque", joint, without / len(torques), "1", "info", message, remedy))
    return tuple(found)
