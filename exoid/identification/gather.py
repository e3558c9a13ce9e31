"""From the arguments of an identification to its task: what the logs say decides on terms, parameters and filters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Preparation
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .drive_constants import refuse_unknown_scale
from .drives import DrivenGroups, Drives
from .estimators import Estimator
from .findings.repeats import counted_once
from .fitting import Task
from .group_rows import Group, Measured
from .groups import make_groups, own_parameters, refuse_nonlinear_terms
from .recording_summary import bases_turn, has_unmeasured_joints, prepare_groups, summarize_groups
from .rotors_apart import rotors_apart
from .unmeasured import only_measured


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
) -> Task:
    """Bring legs, recordings, terms and drives together; no recording is read yet, unless drives make its torque."""
    if own is None and not isinstance(leg, Mapping) and not isinstance(recordings, Mapping):
        groups: tuple[Group, ...] = (Group.alone(leg, recordings),)
    else:
        groups = make_groups(leg, recordings, own)
    task = Task(groups, (), _check_terms(terms), estimator, (), knowledge)
    if actuators is not None:
        driven = DrivenGroups.of(groups, actuators)
        used = driven.default_terms() if terms is None else task.terms
        # known rotors are held; coupled motors have terms of their own
        knowledge = replace(knowledge, known=driven.known_rotors(used, knowledge))
        driven.refuse_unknown(estimator, used, delay, knowledge.names)
        task = Task(
            driven.groups, (), used, estimator, (), knowledge, unknown=driven.unknown, actuators=driven.actuators
        )
    return _with_models(task, own)


def gather(
    task: Task, *, own: str | Sequence[str] | None, preparation: Preparation | str | None, cutoff: float | None
) -> Task:
    """Summarize the recordings, which say what terms and parameters there are, and prepare them for the fit."""
    knowledge, models = task.prior_knowledge, _by_group(task)
    by_noise = preparation is None and cutoff is None
    summaries = summarize_groups(task.groups, models, task.own, knowledge, for_cutoff=by_noise)
    if has_unmeasured_joints(summaries.values()):
        terms, unmeasured = only_measured(task.estimator, task.terms, task.groups, summaries, knowledge)
        task = _with_models(task._replace(terms=terms), own).with_findings(unmeasured)
    if any(len(of_group) > 1 for of_group in summaries.values()):
        groups, summaries, repeats = counted_once(task.groups, _by_group(task), summaries)
        task = task._replace(groups=groups).with_findings(repeats)
    if bases_turn(summaries.values()):
        task = _with_models(task, own, rotors_apart(task.models))
    groups = prepare_groups(task.groups, _by_group(task), summaries, preparation, cutoff)
    if task.unknown is not None:
        refuse_unknown_scale(task.unknown, next(iter(summaries.values())), knowledge)
    source = "that of the preparation passed to identify" if preparation is not None else "passed to identify"
    source = "chosen by the noise of the angles" if by_noise else source
    return task._replace(groups=groups, summaries=tuple(summaries.values()), cutoff_source=source)


def _with_models(task: Task, own: str | Sequence[str] | None, apart: Sequence[str] = ()) -> Task:
    """Make the torque model of each group, and name the parameters that each has of its own."""
    if len(task.groups) > 1:
        refuse_nonlinear_terms({group.name: group.leg for group in task.groups}, task.terms)
    separate = (*task.prior_knowledge.known_names, *apart)
    task = task._replace(models=tuple(TorqueModel.at_start(group.leg, task.terms, separate) for group in task.groups))
    alone = own is None and [group.name for group in task.groups] == [""]
    return task._replace(own=() if alone else own_parameters(_by_group(task), own))


def _by_group(task: Task) -> dict[str, TorqueModel]:
    """Torque models by the names of the groups."""
    return {group.name: model for group, model in zip(task.groups, task.models, strict=True)}


def _check_terms(given: Sequence[Term] | None) -> tuple[Term, ...]:
    """Check that terms are terms, not names of terms."""
    if given is None:
        return DEFAULT_TERMS
    terms = (given,) if isinstance(given, (Term, str)) else tuple(given)
    wrong = [item for item in terms if not isinstance(item, Term)]
    if wrong:
        raise BadArgumentError(
            f"{wrong[0]!r} is no term", remedy="pass terms such as (exoid.Coulomb(), exoid.Viscous())"
        )
    return terms
