"""Joints that move and whose torque was not measured: they give no rows, and terms act on the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from exoid.errors import NotSupportedError
from exoid.estimate.finding import Finding
from exoid.torques import CoordinateTerm, Term

from .estimators import Estimator
from .estimators.by_name import name_of
from .group_rows import Group
from .problem import Problem


def terms_where_measured(problem: Problem, estimator: Estimator, unmeasured: Sequence[str]) -> tuple[Term, ...]:
    """Let terms of all joints act only on joints whose torque was measured, or whose parameters are known."""
    if getattr(estimator, "fits_samples", False):  # friction leaves no trace in the torques of other joints
        what = f"{name_of(estimator)} fits the torque of every joint, and that of some was not measured"
        raise NotSupportedError(what, remedy="use wls, huber or ols")
    labels, given = problem.groups[0].model.leg.joint_labels, problem.given
    known = {*(name.partition("[")[0] for name in given.known), *given.prior.values}
    kept = []
    for term in problem.terms:
        if term.joints is None and not isinstance(term, CoordinateTerm):
            without = {j for j in unmeasured if not {f"{symbol}_{j}" for symbol in term.symbols} <= known}
            joints = tuple(joint for joint in labels if joint not in without)
            kept += [replace(term, joints=joints)] if joints else []
        else:
            kept.append(term)
    return tuple(kept)


def unmeasured_finding(group: Group) -> tuple[Finding, ...]:
    """Say which joints of a group have no torque."""
    summaries, found = group.summaries, list(group.findings)
    torques = [one.torques for one in summaries if one.torques is not None]
    for place, joint in enumerate(group.model.leg.joint_names):
        without = sum(not of_one.measured[place] for of_one in torques)
        if not without:
            continue
        logs = f"{without} of {len(torques)} logs"
        message = f"the torque of {joint} was not measured in {logs}, which have no rows of it"
        remedy = "record it, or declare the joint passive if it has no actuator (passive=, --passive)"
        found.append(Finding("unmeasured-torque", joint, without / len(torques), "1", "info", message, remedy))
    return tuple(found)
