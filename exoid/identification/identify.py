"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import overload

from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.estimate.grouped import GroupedEstimate
from exoid.findings import Finding
from exoid.leg import Leg
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals import Cluster, Poses, Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term

from .checkup import without_delays
from .estimators import Estimator, find_estimator
from .fitting import Task
from .group_checks import refuse_nonlinear_terms
from .groups import Measured, make_groups, own_parameters, prepare_groups, summarize_groups
from .result import Result
from .solving import fit_model
from .variable_projection import starting_model

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
            "finite-difference" (doc. 1), "moving-average" (doc. 2), "smoothed"; ``cutoff`` then does not apply.
        noise: What the covariance assumes of the torque noise: "correlated" (its autocorrelation is estimated from the
            residuals) or "white" (the textbook's formula: intervals far too narrow where it is not).
        known: Parameters that are held fixed, by name, such as a mass that was weighed. An own parameter without its
            group, "c0_hip", is that of all groups, and "c0_hip[left]" that of one.
        prior: Values that parameters are believed to have, with standard deviations, such as
            ``Prior.from_leg(leg, 0.2)`` of a leg with its CAD's inertias. They count as measurements.
        nonnegative: Keep friction and rotor inertia from falling below zero. Without it one that is negative beyond its
            error is named in a warning: something in the model is wrong, which a bound would hide.
        delay: "auto" to estimate by how much torque is late against the motion, joint by joint, and to shift it; a
            finding says by how much. None to take time stamps as they are.
        check: Whether to check logs and fit for faults, which stand in ``findings`` of the estimate: see
            ``docs/checks.md``.

    Returns:
        The estimate with the covariance of its parameters; of groups, one estimate each, with their joint covariance.

    Raises:
        ExoidError: A joint stands still or is missing, torque is missing or never changes, samples are too few,
            parameters are not determined by the recordings (names them and what to do), or groups do not fit together.

    Example:
        >>> est = identify(leg, Recording.from_csv("log.csv"))  # doctest: +SKIP
        >>> both = identify(leg, {"monday": a, "tuesday": b}, own="offset")  # doctest: +SKIP
        >>> both["monday"].torque(q, v, a)  # doctest: +SKIP
    """
    _check_noise(noise)
    _check_delay(delay)
    chosen, terms = find_estimator(estimator), _check_terms(terms)
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
    fitted = fit_model(task)
    shifts: tuple[tuple[Finding, ...], ...] = ()
    if delay is not None:
        task, shifts = without_delays(task, fitted)
        fitted = fit_model(task) if any(shifts) else fitted
    result = Result.of(fitted, list(summaries.values()), chosen, white=noise == "white", check=check, shifts=shifts)
    return result.estimate() if groups[0].name == "" else result.grouped_estimate()


def _check_noise(noise: str) -> None:
    """Check the name of what a covariance assumes."""
    if noise not in NOISES:
        raise ExoidError(f"no noise {noise!r}", remedy=f"use one of {', '.join(NOISES)}")


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
