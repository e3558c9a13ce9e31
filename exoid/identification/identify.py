"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypedDict, Unpack, overload

from exoid.errors import BadArgumentError, ExoidError, NotSupportedError
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS
from exoid.leg.leg import Leg
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import Term

from .checkup import without_delays
from .drive_constants import search_constants, with_found
from .drives import Drives
from .estimators import Estimator
from .estimators.by_name import find_estimator, fit_by, name_of
from .fitting import Fitted, Start, Task
from .gather import begin, gather
from .group_rows import Measured
from .on_ground import FittedOnGround, channel_findings, on_ground, without_outliers
from .problem import Problem
from .recording_summary import are_on_ground
from .result import Result
from .sole_compliance import sole_compliance, tilted
from .variable_projection import search


class FitOptions(TypedDict, total=False):
    """Options of :func:`identify` that all its forms have."""

    cutoff: float | None
    preparation: Preparation | str | None
    noise: str
    known: Mapping[str, float] | None
    prior: Prior | Mapping[str, tuple[float, float]] | None
    nonnegative: bool
    delay: str | None
    check: bool
    actuators: Drives | None


@overload
def identify(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: None = None,
    **options: Unpack[FitOptions],
) -> Estimate: ...


@overload
def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Mapping[str, Measured],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str] | None = None,
    **options: Unpack[FitOptions],
) -> GroupedEstimate: ...


@overload
def identify(
    leg: Leg | Mapping[str, Leg],
    recordings: Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    own: str | Sequence[str],
    **options: Unpack[FitOptions],
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
    if noise not in ("correlated", "white"):
        raise BadArgumentError(f"no noise {noise!r}", remedy="use one of correlated, white")
    if delay not in (None, "auto"):
        raise BadArgumentError(f"no delay {delay!r}", remedy='use delay="auto", or leave it out')
    chosen, white = find_estimator(estimator), noise == "white"
    _refuse_without_effect(chosen, preparation, cutoff)
    knowledge = PriorKnowledge.of(known, prior, nonnegative=nonnegative)
    task = begin(leg, recordings, terms, chosen, knowledge, own=own, actuators=actuators, delay=delay)
    task = gather(task, own=own, preparation=preparation, cutoff=cutoff)
    if are_on_ground(task.groups[0].leg, task.summaries):
        if check:
            task = task.with_findings([channel_findings(task)])
        if delay is not None:
            raise NotSupportedError("delays are not estimated beside contacts", remedy="leave delay out")
        standing = fit_on_ground(task, by_noise=preparation is None and cutoff is None)
        result = Result.of(standing.task, standing.fitted, white=white, check=False)
        return result.standing_estimate(task.models[0], standing.soles)
    fitted = fit_model(task)
    if delay is not None:
        task = without_delays(task, fitted)
        fitted = fit_model(task) if any(of_group.any() for of_group in task.delays) else fitted
    if task.unknown is not None:
        task = task._replace(actuators=(with_found(task.unknown, fitted),))
    result = Result.of(task, fitted, white=white, check=check)
    return result.estimate() if task.groups[0].name == "" else result.grouped_estimate()


def fit_on_ground(task: Task, *, by_noise: bool) -> FittedOnGround:
    """Fit a model to recordings with contacts: once by rows that no outlier moves, and once without the outliers."""
    # Where feet carry a base that was not measured, the compliance of their soles is found, too. What it explains hides
    # no outliers then, which are looked for once more.
    huber = find_estimator("huber")
    task = on_ground(task, by_noise=by_noise)
    try:
        task = without_outliers(task, fit_model(task._replace(estimator=huber)))
    except ExoidError as error:
        more = "let each foot stand while the other moves, and squat, shift and pitch on both"
        error.remedy = f"{error.remedy}; {more}"
        raise
    fitted = fit_model(task)
    soles = sole_compliance(task, fitted)
    if soles is not None:
        task = tilted(task, dict(zip(soles.links, soles.values.tolist(), strict=True)))
        task = without_outliers(task, fit_model(task._replace(estimator=huber))).with_findings([soles.findings()])
        fitted = fit_model(task)
    return FittedOnGround(task._replace(summaries=task.summaries[:1] * len(task.groups)), fitted, soles)


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


def _refuse_without_effect(estimator: Estimator, preparation: Preparation | str | None, cutoff: float | None) -> None:
    """Refuse arguments that would change nothing; estimators refuse others themselves."""
    if preparation is not None and cutoff is not None:
        raise BadArgumentError(
            "cutoff is that of the parallel filter, which preparation replaces", remedy="pass one of them"
        )
    given = [name for name, value in (("cutoff", cutoff), ("preparation", preparation)) if value is not None]
    if given and getattr(estimator, "fits_samples", False):
        raise BadArgumentError(
            f"{name_of(estimator)} fits samples as they were recorded, so that {given[0]} does not apply",
            remedy=f"leave {given[0]} out, or use wls",
        )
