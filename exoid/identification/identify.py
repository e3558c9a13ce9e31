"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import overload

from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS
from exoid.findings import Finding
from exoid.leg import Leg
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals import Cluster, Poses, Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .checkup import without_delays
from .estimators import Estimator, find_estimator, fit_by, name_of
from .fitting import Fitted, Start, Task
from .group_rows import Group, Measured
from .groups import make_groups, own_parameters, refuse_nonlinear_terms
from .problem import Problem
from .recording_summary import prepare_groups, summarize_groups
from .result import Result
from .variable_projection import search

NOISES = ("correlated", "white")


@overload
def identify(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses] | Cluster,
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
) -> GroupedEstimate: ...


def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured] | Cluster,
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
) -> Estimate | GroupedEstimate:
    """Identify the parameters of a leg from recorded motions and torques (docs/identification.md).

    τ = W(q, v, a) β is formed for every sample. Columns and torque pass the same zero-phase low-pass, and β follows by
    least squares on R factors. Groups of recordings share some parameters: β = (shared, own of group 1, own of 2, …).

    Args:
        leg: The leg, of which only the geometry enters; or one for each group by its name, all of one design.
        recordings: Recordings or poses with torques, in memory, on disk or on a cluster; or by the name of their group.
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
        check: Whether to check logs and fit for faults: ``findings`` of the estimate (docs/checks.md).

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
    chosen, terms = find_estimator(estimator), _check_terms(terms)
    _refuse_without_effect(chosen, preparation, cutoff)
    groups = _groups(leg, recordings, own)
    if len(groups) > 1:
        refuse_nonlinear_terms({group.name: group.leg for group in groups}, terms)
    knowledge = PriorKnowledge.of(known, prior, nonnegative=nonnegative)
    models = {group.name: TorqueModel.at_start(group.leg, terms, knowledge.known_names) for group in groups}
    own_names = () if own is None and list(models) == [""] else own_parameters(models, own)
    summaries = summarize_groups(
        groups, models, own_names, knowledge, for_cutoff=preparation is None and cutoff is None
    )
    prepared = prepare_groups(groups, models, summaries, preparation, cutoff)
    task = Task(prepared, tuple(models.values()), terms, chosen, own_names, knowledge)
    fitted = fit_model(task)
    shifts: tuple[tuple[Finding, ...], ...] = ()
    if delay is not None:
        task, shifts = without_delays(task, fitted)
        fitted = fit_model(task) if any(shifts) else fitted
    result = Result.of(fitted, list(summaries.values()), chosen, white=noise == "white", check=check, shifts=shifts)
    return result.estimate() if groups[0].name == "" else result.grouped_estimate()


def fit_model(task: Task, start: Start | None = None) -> Fitted:
    """Fit a model: by one call of the estimator where it is linear in all parameters, else by variable projection.

    Args:
        task: Torque model, data and estimator.
        start: Near the solution, such as that of nearly the same rows; None to search from the start values of the
            nonlinear parameters.

    Returns:
        The fit.

    Raises:
        ExoidError: Parameters are not determined by the rows: names them.
    """
    if any(term.nonlinear or term.loaded for term in task.terms):
        return search(task, start)
    problem = Problem.of(task.groups, task.models, task.own, task.prior_knowledge, task.keep)
    problem.refuse_empty_joints()
    fit = fit_by(task.estimator, problem)
    return Fitted(task.models, fit.solution.values, NO_NONLINEAR_PARAMETERS, problem, fit, fit.warnings)


def _groups(
    leg: Leg | Mapping[str, Leg],
    recordings: Measured | Mapping[str, Measured] | Cluster,
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
