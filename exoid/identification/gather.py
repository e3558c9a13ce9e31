"""From the arguments of an identification to its problem: logs decide on terms, parameters and filters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product

import numpy as np

from exoid.actuators import Actuators, motor_terms
from exoid.actuators.constants import unknown_constants, with_constants
from exoid.errors import BadArgumentError, NotSupportedError, within
from exoid.estimate.finding import Finding
from exoid.estimate.late_velocity import late_velocities
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Preparation, Recording, Recordings, ZeroPhase
from exoid.signals.cutoff import preparation_from
from exoid.signals.preparation import preparation_from_json
from exoid.torques import CoordinateTerm, Term, TorqueModel
from exoid.torques.catalog import terms_of

from .drive_constants import refuse_unknown_scale
from .drives import Drives, computed_joints, known_rotors, refuse_beside_unknown
from .estimators import Estimator
from .estimators.by_name import name_of
from .findings.repeats import counted_once
from .group_rows import Group, Measured, check_recordings
from .groups import own_parameters, pair_groups
from .problem import Problem
from .recording_summary import (
    SMALLEST_MOTION,
    angle_spans,
    refuse_dead_torques,
    refuse_still_joints,
    summarize,
    unmeasured_joints,
)


def begin(
    leg: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured],
    terms: Sequence[Term] | None,
    estimator: Estimator,
    knowledge: PriorKnowledge,
    *,
    own: str | Sequence[str] | None = None,
    actuators: Drives | None = None,
    delay: str | None = None,
) -> Problem:
    """Bring legs, recordings, terms and drives together; no recording is read yet, unless drives make its torque."""
    if own is None and not isinstance(leg, Mapping) and not isinstance(recordings, Mapping):
        pairs = {"": (leg, check_recordings(recordings))}
    else:
        pairs = pair_groups(leg, recordings, own)
    chosen = terms_of(terms)
    mounted: dict[str, Actuators] = {}
    if actuators is not None:
        for name, (of_group, data) in pairs.items():  # torques come before anything else looks at the recordings
            with within(name):
                mounted[name] = Actuators.of(of_group, actuators)
                start = {each.name: each.constant.start for each in unknown_constants(mounted[name])}
                pairs[name] = of_group, with_constants(mounted[name], start).torques(data)
        name, drives = next(iter(mounted.items()))  # drives of all groups are alike
        computed = computed_joints(*pairs[name], drives)
        if terms is None:  # coupled motors have terms of their own
            used = [coupling for coupling in drives.couplings.values() if computed & set(coupling.joints)]
            chosen = (*chosen, *(term for coupling in used for term in motor_terms(coupling)))
        known = known_rotors(pairs[name][0], drives, computed, chosen, knowledge)  # known rotors are held
        knowledge = replace(knowledge, known=known)
        refuse_beside_unknown(mounted, estimator, chosen, delay, knowledge.names)
    loaded = [type(term).__name__ for term in chosen if term.loaded]
    if len(pairs) > 1 and loaded:
        what = f"{', '.join(loaded)}: several groups are fitted together only where torque is linear in all parameters"
        raise NotSupportedError(what, remedy="leave LoadFriction out, or identify them one by one")
    groups = tuple(
        Group(name, model_with(of_group, chosen, knowledge.known), data, actuators=mounted.get(name))
        for name, (of_group, data) in pairs.items()
    )
    return Problem(groups, own_parameters(groups, own), knowledge, chosen)


def gather(
    problem: Problem,
    estimator: Estimator,
    *,
    own: str | Sequence[str] | None,
    preparation: Preparation | str | None,
    cutoff: float | None,
    check: bool,
) -> Problem:
    """Summarize the recordings, which say what terms and parameters there are, and prepare them for the fit."""
    if check:
        problem = replace(problem, groups=tuple(without_late_velocities(group) for group in problem.groups))
    problem = _summarize(problem, for_cutoff=preparation is None and cutoff is None)
    every = [one for group in problem.groups for one in group.summaries]
    if any(one.torques is not None and not one.torques.measured.all() for one in every):
        missing = unmeasured_joints(problem.groups[0].model.leg.joint_labels, every)
        terms = terms_where_measured(problem, estimator, missing)
        told = (replace(group, findings=(*group.findings, *unmeasured_findings(group))) for group in problem.groups)
        problem = _remodelled(replace(problem, groups=tuple(told), terms=terms), own)
    if len(every) > len(problem.groups):
        problem = replace(problem, groups=tuple(counted_once(group) for group in problem.groups))
    if any(one.base_turning > 0.05 for one in every):
        # On a fixed base a rotor at the hip turns with the whole leg, and J1 includes it. Where the torso pitches by ψ,
        # the leg has the acceleration q̈ + ψ̈ and the rotor q̈, which slower turns hardly tell.
        models = [group.model for group in problem.groups]
        pairs = [(model, {one.name for one in model.dependent(moving_base=True)}) for model in models]
        apart = {one.name: None for model, names in pairs for one in model.regrouped if one.name not in names}
        problem = _remodelled(problem, own, tuple(apart))
    if isinstance(preparation, str | float | int):  # a number is no name either, and refused
        preparation = preparation_from_json({"name": preparation})
    groups = []
    for group in problem.groups:
        with within(group.name):
            powers = [one.acceleration_power for one in group.summaries if one.acceleration_power]
            chosen = preparation or (preparation_from(powers) if cutoff is None else ZeroPhase(cutoff))
            refuse_dead_torques(group.model, group.summaries)
        groups.append(replace(group, preparation=chosen, memory_share=1.0 / len(problem.groups)))
        if group.actuators is not None and unknown_constants(group.actuators):
            refuse_unknown_scale(group.actuators, group.summaries, problem.given)
    return replace(problem, groups=tuple(groups))


def without_late_velocities(group: Group) -> Group:
    """Leave out logged velocities that are late, and say so: the derivative of the angles is not."""
    if isinstance(group.data, Recordings):  # on disk, they are read once only
        return group
    findings, data = list(group.findings), list(group.data)
    for k, one in enumerate(data):
        if isinstance(one, Recording):
            found = list(late_velocities(one))
            data[k] = replace(one, v=None, a=None) if found else one
            findings += [replace(each, recording=one.file_name if len(data) > 1 else "") for each in found]
    return replace(group, data=tuple(data), findings=tuple(findings))


def _summarize(problem: Problem, *, for_cutoff: bool) -> Problem:
    """Look through all recordings once, and refuse groups that nothing can be identified from."""
    layout, groups = problem.layout, []
    problem.given.check_regrouped(problem.groups[0].model.regrouped)
    knowledge = problem.prior_knowledge
    for group in problem.groups:
        with within(group.name):
            summaries = [summarize(group.model, one, for_cutoff=for_cutoff) for one in group.data]
            groups.append(replace(group, summaries=summaries))
    for one, other in combinations(groups, 2):
        for a, b in product(one.summaries, other.summaries):
            if a.evidence == b.evidence and np.array_equal(a.mean, b.mean):  # of one file there may be several parts
                name = f"recording {a.source}" if a.source else "the same recording"
                raise BadArgumentError(f"{name} is in {one.name} and in {other.name}", remedy="put it into one of them")
    # shared parameters need a joint that moves in some group, own ones a joint that moves in theirs
    moves = np.any([angle_spans(group.summaries) >= SMALLEST_MOTION for group in groups], axis=0)
    unseen = {name for joint in np.flatnonzero(~moves) for name in groups[0].model.own_parameters(int(joint))}
    seen = [name for name in layout.names[: layout.shared] if name not in unseen]
    for index, group in enumerate(groups):
        with within(group.name):
            known = layout.known_by(index, knowledge).names
            refuse_still_joints(group.model, group.summaries, (*known, *seen))
    return replace(problem, groups=tuple(groups))


def _remodelled(problem: Problem, own: str | Sequence[str] | None, apart: Sequence[str] = ()) -> Problem:
    """Make the torque model of each group anew: terms have changed, or some parameters stand apart."""
    terms, known = problem.terms, problem.given.known
    groups = tuple(replace(group, model=model_with(group.model.leg, terms, known, apart)) for group in problem.groups)
    return replace(problem, groups=groups, own=own_parameters(groups, own))


def model_with(leg: Leg, terms: Sequence[Term], known: Iterable[str], apart: Sequence[str] = ()) -> TorqueModel:
    """Make a torque model: parameters are regrouped into free ones only, since a known one cannot take them in."""
    separate = dict.fromkeys(name.partition("[")[0] for name in known)  # "Ia_hip[left]" is that of one group
    model = TorqueModel(leg, tuple(terms), separate=(*separate, *apart))
    freed = [one.name for one in model.regrouped if not one.into.keys().isdisjoint(separate)]
    return TorqueModel(leg, model.terms, separate=(*separate, *apart, *freed)) if freed else model


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


def unmeasured_findings(group: Group) -> Iterator[Finding]:
    """Say which joints of a group have no torque."""
    torques = [one.torques for one in group.summaries if one.torques is not None]
    for place, joint in enumerate(group.model.leg.joint_names):
        if without := sum(not of_one.measured[place] for of_one in torques):
            logs = f"{without} of {len(torques)} logs"
            message = f"the torque of {joint} was not measured in {logs}, which have no rows of it"
            remedy = "record it, or declare the joint passive if it has no actuator (passive=, --passive)"
            yield Finding("unmeasured-torque", joint, without / len(torques), "1", "info", message, remedy)
