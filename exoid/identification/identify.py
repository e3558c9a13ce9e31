"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import overload

from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS
from exoid.leg import Leg
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals import Cluster, Poses, Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .estimators import Estimator, find_estimator, name_of
from .fitting import Fitted, Start, Task
from .group_checks import refuse_nonlinear_terms
from .groups import Measured, make_groups, own_parameters, prepare_groups, summarize_groups
from .problem import Problem
from .result import Result
from .variable_projection import is_nonlinear, search, starting_model

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
) -> Estimate | GroupedEstimate:
    """Identify the parameters of a leg from recorded motions and torques.

    τ = W(q, v, a) β is formed for every sample. Columns and torque pass the same zero-phase low-pass (the parallel
    filter), the ends that filters spoil are removed, and β follows by least squares on an orthogonal factorisation.
    With ``own``, or with recordings by name, each group of recordings (a leg, a session) has some parameters of its
    own and shares the others: β = (shared, own of the first group, own of the second, …). Every group has noise of its
    own, joint by joint, and its own cut-off.

    Args:
        leg: The leg, or one for each group by its name; its inertias do not enter, only its geometry. Legs of groups
            have the same joints and geometry.
        recordings: One recording or several of the same leg, with torques; also :class:`exoid.signals.Poses`. Velocity
            and acceleration are derived where they are missing. :class:`exoid.signals.Recordings` stay on disk, and a
            :class:`exoid.signals.Cluster` keeps them on its workers. Groups have names, such as
            {"left": left, "right": [first, second]}; without names, each recording is a group if ``own`` is given.
        terms: What acts on the joints besides rigid-body dynamics; None for Coulomb and viscous friction, rotor
            inertia and offset at every joint; () for nothing. Settings that are
            :class:`exoid.torques.NonlinearParameter` are found by variable projection, and stand in ``nonlinear`` of
            the estimate; with several groups they must be numbers.
        estimator: "wls" (each joint, at rest and in motion, weighted by its residuals), "huber" (the same, and spikes
            count less), "gls" (whitened by a model of the noise; only where the model of the leg is right), "ml"
            (motion and parameters together; where angles are noisy and the model is right) or "ols". Also an object
            with settings, such as :class:`exoid.identification.estimators.OutputError`, or your own function.
        own: Parameters that each group has of its own: symbols such as "offset" or "c0", which mean all joints, or
            names such as "c0_hip" or "J1"; () for nothing but noise. None for one group, or for everything but the
            rigid bodies where recordings have names.
        cutoff: Cut-off frequency of the parallel filter [Hz]; above the fastest motion, below the noise. None to choose
            it from the noise of the angles, at most 8 Hz, see :func:`exoid.signals.choose_cutoff`.
        preparation: Another way from a recording to rows, such as :class:`exoid.signals.MovingAverage`, or its name:
            "finite-difference" (doc. 1), "moving-average" (doc. 2), "smoothed"; ``cutoff`` is then refused.
        noise: What the covariance assumes of the torque noise: "correlated" (its autocorrelation is estimated from the
            residuals, and it may change in size or be common to joints) or "white" (the textbook's formula: intervals
            far too narrow where it is not).
        known: Parameters that are held fixed, by name, such as a mass that was weighed. An own parameter without its
            group, "c0_hip", is that of all groups, and "c0_hip[left]" that of one.
        prior: Values that parameters are believed to have, with standard deviations, such as
            ``Prior.from_leg(leg, 0.2)`` of a leg with its CAD's inertias. They count as measurements.
        nonnegative: Keep friction and rotor inertia from falling below zero. Without it one that is negative beyond its
            error is named in a warning: something in the model is wrong, which a bound would hide.

    Returns:
        The estimate with the covariance of its parameters; of groups, one estimate each, with their joint covariance.

    Raises:
        ExoidError: The estimator cannot act on an argument, a joint stands still or is missing, torque is missing or
            never changes, samples are too few, parameters are not determined by the recordings (names them and what to
            do), or groups do not fit together.

    Example:
        >>> est = identify(leg, Recording.from_csv("log.csv"))  # doctest: +SKIP
        >>> both = identify(leg, {"monday": a, "tuesday": b}, own="offset")  # doctest: +SKIP
        >>> both["monday"].torque(q, v, a)  # doctest: +SKIP
    """
    _check_noise(noise)
    chosen, terms = find_estimator(estimator), _check_terms(terms)
    _refuse_without_effect(chosen, preparation, cutoff)
    groups = make_groups(leg, recordings, own)
    if len(groups) > 1:
        refuse_nonlinear_terms({group.name: group.leg for group in groups}, terms)
    models = {group.name: starting_model(group.leg, terms) for group in groups}
    own_names = own_parameters(models, own)
    knowledge = PriorKnowledge.of(known, prior, nonnegative=nonnegative)
    summaries = summarize_groups(
        groups, models, own_names, knowledge, for_cutoff=preparation is None and cutoff is None
    )
    task = Task(prepare_groups(groups, models, summaries, preparation, cutoff), terms, chosen, own_names, knowledge)
    result = Result.of(fit_model(task), list(summaries.values()), chosen, white=noise == "white")
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
    if is_nonlinear(task.groups[0].leg, task.terms):
        return search(task, start)
    models = tuple(TorqueModel(group.leg, task.terms) for group in task.groups)
    problem = Problem.of(task.groups, models, task.own, task.prior_knowledge, task.keep)
    problem.refuse_empty_joints()
    fit = task.estimator(problem)
    return Fitted(models, fit.solution.values, NO_NONLINEAR_PARAMETERS, problem, fit, fit.warnings)


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


def _check_terms(given: Sequence[Term] | None) -> tuple[Term, ...]:
    """Check that terms are terms, not names of terms."""
    if given is None:
        return DEFAULT_TERMS
    terms = (given,) if isinstance(given, (Term, str)) else tuple(given)
    wrong = [item for item in terms if not isinstance(item, Term)]
    if wrong:
        raise ExoidError(f"{wrong[0]!r} is no term", remedy="pass terms such as (exoid.Coulomb(), exoid.Viscous())")
    return terms
