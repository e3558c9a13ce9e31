"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, overload

from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS
from exoid.leg.leg import Leg
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .checkup import without_delays
from .drive_constants import refuse_unknown_scale, search_constants, with_found
from .drives import DrivenGroups, Drives
from .estimators import Estimator, find_estimator, fit_by, name_of
from .findings.repeats import counted_once
from .fitting import Fitted, Start, Task
from .group_rows import Group, Measured
from .groups import make_groups, own_parameters, refuse_nonlinear_terms
from .on_ground import FittedOnGround, channel_findings, on_ground, without_outliers
from .problem import Problem
from .recording_summary import (
    RecordingSummary,
    are_on_ground,
    bases_turn,
    has_unmeasured_joints,
    prepare_groups,
    summarize_groups,
)
from .result import Preliminaries, Result
from .rotors_apart import rotors_apart
from .sole_compliance import sole_compliance, tilted
from .unmeasured import only_measured
from .variable_projection import search

NOISES = ("correlated", "white")


@overload
def identify(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: None = None,
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    noise: str = "correlated",
    known: Mapping[str, float] | None = None,
    prior: Prior | Mapping[str, tuple[float, float]] | None = None,
    nonnegative: bool = False,
    delay: str | None = None,
    check: bool = True,
    actuators: Drives | None = None,
) -> Estimate: ...


@overload
def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Mapping[str, Measured],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str] | None = None,
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    noise: str = "correlated",
    known: Mapping[str, float] | None = None,
    prior: Prior | Mapping[str, tuple[float, float]] | None = None,
    nonnegative: bool = False,
    delay: str | None = None,
    check: bool = True,
    actuators: Drives | None = None,
) -> GroupedEstimate: ...


@overload
def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str],
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    noise: str = "correlated",
    known: Mapping[str, float] | None = None,
    prior: Prior | Mapping[str, tuple[float, float]] | None = None,
    nonnegative: bool = False,
    delay: str | None = None,
    check: bool = True,
    actuators: Drives | None = None,
) -> GroupedEstimate: ...


def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str] | None = None,
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    noise: str = "correlated",
    known: Mapping[str, float] | None = None,
    prior: Prior | Mapping[str, tuple[float, float]] | None = None,
    nonnegative: bool = False,
    delay: str | None = None,
    check: bool = True,
    actuators: Drives | None = None,
) -> Estimate | GroupedEstimate:
    """Identify the parameters of a leg from recorded motions and torques (docs/identification.md).

    τ = W(q, v, a) β is formed for every sample. Columns and torque pass the same zero-phase low-pass, and β follows by
    least squares on R factors. Groups of recordings share some parameters: β = (shared, own of group 1, own of 2, …).

    Args:
        leg: The leg, of which only the geometry enters; or one for each group by its name, all of one design.
        recordings: Recordings or poses with torques, in memory or on disk; or by the name of their group.
        terms: Terms beside rigid-body dynamics; None for Coulomb and viscous friction, armature and offset.
        estimator: "wls" (weighted by residuals), "huber" (robust), "gls" (whitened), "ml" (with noise in the angles),
            "ols", or an estimator, such as :class:`exoid.identification.estimators.OutputError` or your function.
        own: Symbols ("offset") or names ("J1") that each group has of its own; each recording is a group unless groups
            have names. None for one group, or for all but the rigid bodies where groups have names.
        cutoff: Cut-off frequency of the low-pass [Hz]; None for at most 8 Hz, by the noise of the angles.
        preparation: Another way from a recording to rows, or its name; ``cutoff`` then does not apply.
        noise: "correlated" (by the residuals, also between joints) or "white" for the covariance.
        known: Values of parameters that are held fixed, by name; "c0_hip[left]" is that of one group. A known rotor of
            the first joint, "Ia_hip", is no part of J1 then.
        prior: Value and standard deviation of parameters, by name, or ``Prior.from_leg(leg, 0.2)``.
        nonnegative: Whether to bound friction and rotor inertia by zero.
        delay: "auto" to estimate by how much torques are late, and to shift them; None to leave them as they are.
        check: Whether to check logs and fit for faults, ``findings`` of the estimate (docs/checks.md), and for friction
            of other forms, which widens bands (``model_error``).
        actuators: Drives that turn currents, forces or motor angles of the recordings into torque: one for each joint
            by its name, such as :class:`exoid.actuators.Motor` (docs/drives.md); None for torques. Constants of drives
            that are not known are identified where something is known in N·m, such as a payload (docs/amperes.md).

    Returns:
        The estimate; with groups, one for each with their joint covariance.

    Raises:
        ExoidError: Recordings are unfit, do not identify all parameters (names them), groups do not fit together, or
            the estimator cannot act on an argument.

    Example:
        >>> both = identify(leg, {"monday": a, "tuesday": b}, own="offset")  # doctest: +SKIP
    """
    _check_noise(noise)
    _check_delay(delay)
    chosen = find_estimator(estimator)
    _refuse_without_effect(chosen, preparation, cutoff)
    knowledge = PriorKnowledge.of(known, prior, nonnegative=nonnegative)
    inputs = _Inputs(_groups(leg, recordings, own), _check_terms(terms), knowledge)
    if actuators is not None:
        inputs = inputs.driven(actuators, chosen, delay, default_terms=terms is None)
    task, summaries, before = _gather(inputs, chosen, own, preparation, cutoff)
    if are_on_ground(task.groups[0].leg, summaries.values()):
        by_noise = preparation is None and cutoff is None
        before = before.beside_others([channel_findings(task)]) if check else before
        return _on_ground(task, summaries, before, delay, by_noise=by_noise, white=noise == "white")
    fitted = fit_model(task)
    if delay is not None:
        task, delays, shifts = without_delays(task, fitted)
        fitted = fit_model(task) if any(shifts) else fitted
        before = before.shifted(delays, shifts)
    if task.unknown is not None:
        before = before._replace(actuators=(with_found(task.unknown, fitted),))
    result = Result.of(fitted, list(summaries.values()), chosen, white=noise == "white", check=check, before=before)
    return result.estimate() if task.groups[0].name == "" else result.grouped_estimate()


class _Inputs(NamedTuple):
    """What an identification begins with."""

    groups: tuple[Group, ...]  # groups of recordings
    terms: tuple[Term, ...]  # terms beside rigid-body dynamics
    knowledge: PriorKnowledge  # what is known beside the recordings
    drives: DrivenGroups | None = None  # drives of which torques were computed; None without drives

    def driven(self, drives: Drives, estimator: Estimator, delay: str | None, *, default_terms: bool) -> _Inputs:
        """Turn readings of drives into torque; coupled motors have terms, and known rotors are held."""
        found = DrivenGroups.of(self.groups, drives)
        terms = found.default_terms() if default_terms else self.terms
        known = found.known_rotors(terms, self.knowledge)
        found.refuse_unknown(estimator, terms, delay, (*known, *self.knowledge.prior.values))
        return _Inputs(found.groups, terms, replace(self.knowledge, known=known), found)


def _gather(
    inputs: _Inputs,
    estimator: Estimator,
    own: str | Sequence[str] | None,
    preparation: Preparation | str | None,
    cutoff: float | None,
) -> tuple[Task, dict[str, list[RecordingSummary]], Preliminaries]:
    """Summarize the recordings, which say what terms and parameters there are, and prepare them for the fit."""
    groups, terms, knowledge, drives = inputs
    before = Preliminaries(cutoff_source=_cutoff_source(preparation, cutoff))
    if drives is not None:
        before = before._replace(actuators=drives.actuators)
    unknown = None if drives is None else drives.unknown
    models, own_names = _models(groups, terms, knowledge, own)
    by_noise = preparation is None and cutoff is None
    summaries = summarize_groups(groups, models, own_names, knowledge, for_cutoff=by_noise)
    if has_unmeasured_joints(summaries.values()):
        terms, unmeasured = only_measured(estimator, terms, groups, summaries, knowledge)
        models, own_names = _models(groups, terms, knowledge, own)
        before = before.beside_others(unmeasured)
    if any(len(of_group) > 1 for of_group in summaries.values()):
        groups, summaries, repeats = counted_once(groups, models, summaries)
        before = before.beside_others(repeats)
    if bases_turn(summaries.values()):
        models, own_names = _models(groups, terms, knowledge, own, rotors_apart(models.values()))
    prepared = prepare_groups(groups, models, summaries, preparation, cutoff)
    if unknown is not None:
        refuse_unknown_scale(unknown, next(iter(summaries.values())), knowledge)
    task = Task(prepared, tuple(models.values()), terms, estimator, own_names, knowledge, unknown=unknown)
    return task, summaries, before


def _models(
    groups: Sequence[Group],
    terms: Sequence[Term],
    knowledge: PriorKnowledge,
    own: str | Sequence[str] | None,
    apart: Sequence[str] = (),
) -> tuple[dict[str, TorqueModel], tuple[str, ...]]:
    """Torque model of each group, and names of the parameters that each has of its own."""
    if len(groups) > 1:
        refuse_nonlinear_terms({group.name: group.leg for group in groups}, terms)
    separate = (*knowledge.known_names, *apart)
    models = {group.name: TorqueModel.at_start(group.leg, terms, separate) for group in groups}
    return models, () if own is None and list(models) == [""] else own_parameters(models, own)


def _cutoff_source(preparation: Preparation | str | None, cutoff: float | None) -> str:
    """Say how the cut-off was chosen."""
    if preparation is not None:
        return "that of the preparation passed to identify"
    return "chosen by the noise of the angles" if cutoff is None else "passed to identify"


def _on_ground(
    task: Task,
    summaries: Mapping[str, Sequence[RecordingSummary]],
    before: Preliminaries,
    delay: str | None,
    *,
    by_noise: bool,
    white: bool,
) -> Estimate:
    """Identify a leg that stands."""
    if delay is not None:
        raise ExoidError("delays are not estimated beside contacts", remedy="leave delay out")
    standing = fit_on_ground(task, by_noise=by_noise)
    before = before.beside_others([standing.findings])
    (of_all,) = summaries.values()
    groups = [of_all] * len(standing.task.groups)
    result = Result.of(standing.fitted, groups, task.estimator, white=white, before=before)
    return result.standing_estimate(standing.model, standing.soles)


def fit_on_ground(task: Task, *, by_noise: bool) -> FittedOnGround:
    """Fit a model to recordings with contacts: once by rows that no outlier moves, and once without the outliers."""
    # Where feet carry a base that was not measured, the compliance of their soles is found, too. What it explains hides
    # no outliers then, which are looked for once more.
    standing = on_ground(task, by_noise=by_noise)
    try:
        robust = fit_model(standing.task._replace(estimator=find_estimator("huber")))
    except ExoidError as error:
        more = "let each foot stand while the other moves, and squat, shift and pitch on both"
        raise ExoidError(error.what, where=error.where, remedy=f"{error.remedy}; {more}") from error
    kept, outliers = without_outliers(standing.task, robust)
    fitted = fit_model(kept)
    soles = sole_compliance(kept, fitted)
    if soles is not None:
        kept = tilted(kept, dict(zip(soles.links, soles.values.tolist(), strict=True)))
        kept, smaller = without_outliers(kept, fit_model(kept._replace(estimator=find_estimator("huber"))))
        fitted, outliers = fit_model(kept), (*outliers, *smaller, *soles.findings())
    return FittedOnGround(kept, fitted, standing.model, (*standing.findings, *outliers), soles)


def fit_model(task: Task, start: Start | None = None) -> Fitted:
    """Fit a model: by one call of the estimator where it is linear in all parameters, else by variable projection."""
    if task.unknown is not None:
        return search_constants(task, task.unknown)
    if any(term.nonlinear or term.loaded for term in task.terms):
        return search(task, start)
    problem = Problem.of(task.groups, task.models, task.own, task.prior_knowledge, task.keep)
    problem.refuse_empty_joints()
    fit = fit_by(task.estimator, problem)
    return Fitted(task.models, fit.solution.values, NO_NONLINEAR_PARAMETERS, problem, fit, fit.warnings)


def _groups(
    leg: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured],
    own: str | Sequence[str] | None,
) -> tuple[Group, ...]:
    """Bring legs and recordings together: one group, unless one of the arguments speaks of several."""
    if own is None and not isinstance(leg, Mapping) and not isinstance(recordings, Mapping):
        return (Group.alone(leg, recordings),)
    return make_groups(leg, recordings, own)


def _check_noise(noise: str) -> None:
    """Check the name of what a covariance assumes."""
    if noise not in NOISES:
        raise ExoidError(f"no noise {noise!r}", remedy=f"use one of {', '.join(NOISES)}")


def _refuse_without_effect(estimator: Estimator, preparation: Preparation | str | None, cutoff: float | None) -> None:
    """Refuse arguments that would change nothing; estimators refuse others themselves."""
    if preparation is not None and cutoff is not None:
        raise ExoidError("cutoff is that of the parallel filter, which preparation replaces", remedy="pass one of them")
    given = [name for name, value in (("cutoff", cutoff), ("preparation", preparation)) if value is not None]
    if given and getattr(estimator, "fits_samples", False):
        raise ExoidError(
            f"{name_of(estimator)} fits samples as they were recorded, so that {given[0]} does not apply",
            remedy=f"leave {given[0]} out, or use wls",
        )


def _check_delay(delay: str | None) -> None:
    """Check how delays are treated."""
    if delay not in (None, "auto"):
        raise ExoidError(f"no delay {delay!r}", remedy='use delay="auto", or leave it out')


def _check_terms(given: Sequence[Term] | None) -> tuple[Term, ...]:
    """Check that terms are terms, not names of terms."""
    if given is None:
        return DEFAULT_TERMS
    terms = (given,) if isinstance(given, (Term, str)) else tuple(given)
    wrong = [item for item in terms if not isinstance(item, Term)]
    if wrong:
        raise ExoidError(f"{wrong[0]!r} is no term", remedy="pass terms such as (exoid.Coulomb(), exoid.Viscous())")
    return terms
