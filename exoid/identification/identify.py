"""The one call from a leg and recordings to an estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from os import PathLike

import numpy as np

from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.leg import Leg
from exoid.regression.degrees_of_freedom import degrees_of_freedom
from exoid.regression.diagnostics import calm_sizes, judge_noise, judge_sizes, negative
from exoid.regression.influence import influence
from exoid.regression.prior_knowledge import Assumed, Prior
from exoid.regression.r_factor import rms_residual
from exoid.regression.residuals import sandwich
from exoid.regression.trends import remarks, residual_trends
from exoid.signals import Cluster, Poses, Preparation, Recording, Recordings, ZeroPhase, preparation_by_name
from exoid.signals.cutoff import cutoff_from
from exoid.torques import DEFAULT_TERMS, Term

from .estimators import Estimator, find_estimator, name_of
from .fitting import Task, starting_model
from .recording_summary import Survey, angles, refuse_dead_torques, refuse_still_joints, survey
from .separable import fit_model
from .sources import go_over

NOISES = ("correlated", "white")


def identify(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses] | Cluster,
    terms: Sequence[Term] | None = None,
    estimator: str | Estimator = "wls",
    *,
    cutoff: float | None = None,
    preparation: Preparation | str | None = None,
    noise: str = "correlated",
    known: Mapping[str, float] | None = None,
    prior: Prior | Mapping[str, tuple[float, float]] | None = None,
    nonnegative: bool = False,
) -> Estimate:
    """Identify the parameters of a leg from recorded motions and torques.

    τ = W(q, v, a) β is formed for every sample, columns and torque pass the same zero-phase low-pass (the parallel
    filter), the ends that filters spoil are removed, and β follows by least squares on an orthogonal factorisation.

    Args:
        leg: The leg; its inertias do not enter, only its geometry.
        recordings: One recording or several of the same leg, with torques; also :class:`exoid.signals.Poses`. Velocity
            and acceleration are derived where they are missing. :class:`exoid.signals.Recordings` stay on disk, and a
            :class:`exoid.signals.Cluster` keeps them on its workers.
        terms: What acts on the joints besides rigid-body dynamics; None for Coulomb and viscous friction, rotor
            inertia and offset at every joint; () for nothing. Settings that are :class:`exoid.torques.Free` are found
            by separable least squares, and stand in ``shapes`` of the estimate.
        estimator: "wls" (each joint, at rest and in motion, weighted by its residuals), "huber" (the same, and spikes
            count less), "gls" (whitened by a model of the noise; only where the model of the leg is right), "ml"
            (motion and parameters together; where angles are noisy and the model is right) or "ols". Also an object
            with settings, such as :class:`exoid.identification.estimators.OutputError`.
        cutoff: Of the parallel filter [Hz]; above the fastest motion, below the noise. None to choose it from the noise
            of the angles, at most 8 Hz, see :func:`exoid.signals.choose_cutoff`.
        preparation: Another way from a recording to rows, such as :class:`exoid.signals.MovingAverage`, or its name:
            "finite-difference" (doc. 1), "moving-average" (doc. 2), "smoothed"; ``cutoff`` then does not apply.
        noise: What the covariance assumes of the torque noise: "correlated" (its autocorrelation is estimated from the
            residuals) or "white" (the textbook's formula: intervals far too narrow where it is not).
        known: Parameters that are held fixed, by name, such as a mass that was weighed.
        prior: Values that others are believed to have, with standard deviations, such as
            ``Prior.from_leg(leg, 0.2)`` of a leg with its CAD's inertias. They count as measurements.
        nonnegative: Keep friction and rotor inertia from falling below zero. Without it one that is negative beyond its
            error is named in a warning: something in the model is wrong, which a bound would hide.

    Returns:
        The estimate, with the covariance of its parameters.

    Raises:
        ExoidError: A joint stands still or is missing, torque is missing or never changes, samples are too few, or
            parameters are not determined by the recordings: names them and what to do.

    Example:
        >>> est = identify(leg, Recording.from_csv("log.csv"))  # doctest: +SKIP
    """
    recordings = recordings if isinstance(recordings, Cluster) else check_recordings(recordings)
    estimate = find_estimator(estimator)
    check_noise(noise)
    terms = check_terms(terms)
    model = starting_model(leg, terms)
    assumed = Assumed(known or {}, prior if isinstance(prior, Prior) else Prior(prior or {}), nonnegative)
    assumed.check(model)
    listen = preparation is None and cutoff is None
    surveys = go_over(recordings, partial(survey, model, listen=listen))
    refuse_still_joints(model, surveys, assumed.names)
    preparation = choose_preparation(surveys, preparation, cutoff)
    refuse_dead_torques(model, surveys)
    fitted = fit_model(Task(leg, terms, recordings, preparation, estimate, assumed=assumed))
    problem, fit = fitted.problem, fitted.fit
    solution, count = fit.solution, len(fitted.values)
    covariance, noises, dofs = solution.covariance, fit.noises, fit.dofs
    if noises is None:
        covariance, noises = sandwich(problem, fit.point, solution)
        settled = solution._replace(covariance=covariance)
        dofs = degrees_of_freedom(problem, fit.point, noises, settled, whitened=False)
    judged = judge_noise(problem, fit.point, noises)
    independent = sum(of_joint.effective_samples for of_joint in judged)
    residuals = [rms_residual(of_joint, solution.values) for of_joint in zip(*problem.groups, strict=True)]
    if noise == "white":
        covariance, dof, dofs = solution.covariance, solution.dof, None
    else:
        dof = max(1.0, independent - int(assumed.free(problem.names).sum()))
    inputs = tuple(one.evidence for one in surveys)
    followed = prior and (fit.noises is None or fit.dofs is not None)  # ml and output error minimise something else
    trends = residual_trends(problem, fit.point, noises, solution, covariance, whitened=fit.noises is not None)
    std = np.sqrt(np.diag(covariance))
    shapes = fitted.shapes.with_covariance(problem.names[count:], covariance[count:, count:])
    collinearity = solution.collinearity
    doubts = (
        *shapes.doubts,
        *collinearity.remarks(problem.names),
        *negative(fitted.model, fitted.values, std[:count]),
        *remarks(trends),
    )
    return Estimate(
        model=fitted.model,
        values=fitted.values,
        covariance=covariance[:count, :count],
        condition_number=solution.condition_number,
        dof=dof,
        dof_each=np.full(count, dof) if dofs is None else np.clip(dofs[:count], 1.0, dof),
        residual_rms=np.array(residuals),
        estimator=fit.name or name_of(estimate),
        preparation=preparation,
        inputs=inputs,
        noise=judged,
        sizes=judge_sizes(problem.triangles)[:count],
        calm_sizes=calm_sizes(fitted.model.loaded_by(fitted.values), *angles(surveys), problem.triangles),
        collinearity=collinearity.indices[:count],
        prior_gains=solution.prior_gains(problem.names, assumed)[:count] if followed else np.zeros((0, 0)),
        warnings=(*fitted.remarks, *doubts),
        shapes=shapes,
        assumed=assumed,
        bounded=tuple(problem.names[k] for k in solution.bounded),
        influence=influence(problem, [source.name for source in inputs], fit, std, count),
        trends=trends,
    )


def check_noise(noise: str) -> None:
    """Check the name of what a covariance assumes."""
    if noise not in NOISES:
        raise ExoidError(f"no noise {noise!r}", remedy=f"use one of {', '.join(NOISES)}")


def choose_preparation(surveys: Sequence[Survey], given: Preparation | str | None, cutoff: float | None) -> Preparation:
    """Take the preparation that was given, or the parallel filter with a cut-off given or chosen from recordings."""
    if isinstance(given, str):
        return preparation_by_name(given)
    if given is not None:
        return given
    return ZeroPhase(cutoff_from([one.bends for one in surveys if one.bends]) if cutoff is None else cutoff)


def check_recordings(given: Recording | Poses | Iterable[Recording | Poses]) -> Sequence[Recording | Poses]:
    """Check that there is at least one recording, and nothing else; those on disk stay there."""
    if isinstance(given, Recordings) and len(given):
        return given
    several = [given] if isinstance(given, (Recording, Poses, str, PathLike)) else list(given)
    wrong = [item for item in several if not isinstance(item, (Recording, Poses, Recordings))]
    if wrong or not several:
        what = f"{wrong[0]!r} is no recording" if wrong else "no recordings"
        raise ExoidError(what, remedy='pass at least one, such as Recording.from_csv("log.csv")')
    if any(isinstance(item, Recordings) for item in several):
        items = (item.items if isinstance(item, Recordings) else (item,) for item in several)
        return Recordings(tuple(each for of_item in items for each in of_item))
    return several


def check_terms(given: Sequence[Term] | None) -> tuple[Term, ...]:
    """Check that terms are terms, not names of terms."""
    if given is None:
        return DEFAULT_TERMS
    terms = (given,) if isinstance(given, (Term, str)) else tuple(given)
    wrong = [item for item in terms if not isinstance(item, Term)]
    if wrong:
        raise ExoidError(f"{wrong[0]!r} is no term", remedy="pass terms such as (exoid.Coulomb(), exoid.Viscous())")
    return terms
