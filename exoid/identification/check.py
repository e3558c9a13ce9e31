"""The one call from a leg and recordings to findings: mistakes of logs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from exoid.errors import ExoidError
from exoid.estimate.finding import Finding, ordered
from exoid.leg.leg import Leg
from exoid.regression.fit import uncertainty_of
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .checkup import check_group
from .drive_constants import refuse_unknown_scale, with_found
from .drives import DrivenGroups, Drives
from .estimators import find_estimator
from .findings import signal_findings
from .fitting import Task
from .group_rows import Group
from .identify import fit_model, fit_on_ground
from .recording_summary import are_on_ground, bases_turn, has_unmeasured_joints, prepare_groups, summarize_groups
from .repeats import counted_once
from .rotors_apart import rotors_apart
from .unmeasured import only_measured


def check(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    *,
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    known: Mapping[str, float] | None = None,
    actuators: Drives | None = None,
) -> tuple[Finding, ...]:
    """Check logs for the mistakes that real logs have.

    Channels are checked first: rails, frozen and repeated values, dropouts, missing samples. Then the leg is
    identified, and the residuals are tested against late torques, wrong zeros and scales, a tilted base, wrong lengths,
    straps and friction of another form. ``docs/checks.md`` lists all kinds of findings.

    Args:
        leg: The leg.
        recordings: One recording or several of the same leg, with torques.
        terms: Terms besides rigid-body dynamics; None for those of :func:`exoid.identify`.
        cutoff: Cut-off frequency of the parallel filter [Hz]; None to choose it.
        preparation: Another way from a recording to rows, or its name.
        known: Parameters that are known, by name.
        actuators: Drives of the recordings, as for :func:`exoid.identify`; None for torques.

    Returns:
        Findings, the worst first; empty where nothing was found. A log that nothing can be identified from has the
        finding "not-identifiable".

    Raises:
        ExoidError: There is no recording, or a joint of the leg is not in it.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> exoid.check(data.leg, data.train)
        ()
    """
    used = DEFAULT_TERMS if terms is None else tuple(terms)
    groups: tuple[Group, ...] = (Group.alone(leg, recordings),)
    mounted, unknown, knowledge = None, None, PriorKnowledge.of(known, None, nonnegative=False)
    if actuators is not None:
        driven = DrivenGroups.of(groups, actuators)
        used = driven.default_terms() if terms is None else used
        groups, mounted = driven.groups, driven.actuators[0]
        knowledge = replace(knowledge, known=driven.known_rotors(used, knowledge))
        driven.refuse_unknown(find_estimator("wls"), used, None, knowledge.names)
        unknown = driven.unknown
    model = TorqueModel.at_start(leg, used, tuple(knowledge.known))
    data = groups[0].data
    signals = signal_findings(model, data)
    try:
        summaries = summarize_groups(
            groups, {"": model}, (), knowledge, for_cutoff=preparation is None and cutoff is None
        )
        if has_unmeasured_joints(summaries.values()):
            used, (unmeasured,) = only_measured(find_estimator("wls"), used, groups, summaries, knowledge)
            model = TorqueModel.at_start(leg, used, tuple(knowledge.known))
            signals = (*signals, *unmeasured)
        groups, summaries, (repeats,) = counted_once(groups, {"": model}, summaries)
        if bases_turn(summaries.values()):
            model = TorqueModel.at_start(leg, used, (*knowledge.known, *rotors_apart([model])))
        prepared = prepare_groups(groups, {"": model}, summaries, preparation, cutoff)
        if unknown is not None:
            refuse_unknown_scale(unknown, summaries[""], knowledge)
        task = Task(prepared, (model,), used, find_estimator("wls"), (), knowledge, unknown=unknown)
        if are_on_ground(leg, summaries.values()):
            standing = fit_on_ground(task, by_noise=preparation is None and cutoff is None)
            return ordered((*repeats, *signals, *standing.findings))
        fitted = fit_model(task)
    except ExoidError as error:
        refused = Finding("not-identifiable", "", 1.0, "1", "error", error.what, error.remedy, parameters=model.names)
        return ordered((*signals, refused))
    covariance = uncertainty_of(fitted.problem, fitted.fit, white=False).covariance
    count = len(fitted.models[0].names)
    without = (finding for finding in signals if finding.kind == "unmeasured-torque")
    mounted = mounted if unknown is None else with_found(unknown, fitted)
    return ordered((*repeats, *without, *check_group(fitted, 0, covariance[:count, :count], mounted).findings))
