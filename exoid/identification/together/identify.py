"""The one call from several legs or sessions to estimates that share parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.estimate import Estimate
from exoid.identification.estimators import Estimator, Fit, find_estimator, gls, huber, name_of, ols, wls
from exoid.identification.identify import check_noise, check_terms, choose_preparation
from exoid.identification.problem import Problem
from exoid.identification.recording_summary import Survey, refuse_dead_torques, survey
from exoid.leg import Leg
from exoid.regression.diagnostics import judge_sizes
from exoid.regression.prior_knowledge import Assumed, Prior
from exoid.regression.problem import Stacked
from exoid.regression.r_factor import join, refuse_empty_joints
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import Term, TorqueModel, free_shapes

from .agreement import own_equality, shared_agreement
from .groups import (
    Group,
    Recordings,
    make_groups,
    refuse_other_designs,
    refuse_same_recordings,
    refuse_still_groups,
    within,
)
from .layout import Layout
from .outcome import Outcome
from .problem import JointProblem
from .result import Together
from .trust import samples_left

POINTWISE: Mapping[str, Callable[[Stacked], Fit]] = {"gls": gls, "huber": huber, "ols": ols, "wls": wls}
"""Estimators that weigh rows, whichever leg they come from."""


def identify_together(
    legs: Leg | Mapping[str, Leg],
    groups: Mapping[str, Recordings] | Sequence[Recording | Poses],
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
) -> Together:
    """Identify several legs of one design, or several sessions, at once: some parameters shared, others each its own.

    The rows of all groups are one least-squares problem τ = W β with β = (shared, own of the first group, own of the
    second, …). Every group has noise of its own, joint by joint: its weights and the noise model behind its intervals,
    and its own cut-off.

    Args:
        legs: The leg, or one for each group. The same joints and the same geometry, so that parameters mean the same.
        groups: Recordings and poses by the name of the group, such as {"left": left, "right": [first, second]}; or
            recordings alone, each a group with the name of its file.
        terms: As for :func:`exoid.identify`, the same for all groups; their settings are numbers, and friction does not
            depend on the load.
        estimator: "wls", "huber", "gls" or "ols".
        own: What each group has of its own: symbols such as "offset" or "c0", which mean all joints, or names such as
            "c0_hip" or "J1". None for everything but the rigid bodies; () for nothing but noise.
        cutoff: As for :func:`exoid.identify`; None to choose one for each group.
        preparation: As there.
        noise: As there.
        known: As there; an own parameter without its group, "c0_hip", is that of all, and "c0_hip[left]" that of one.
        prior: As there.
        nonnegative: As there.

    Returns:
        The estimates, one for each group, with their joint covariance.

    Raises:
        ExoidError: As for :func:`exoid.identify`, and where groups do not fit together; says which.

    Example:
        >>> both = identify_together(leg, {"monday": a, "tuesday": b}, own="offset")  # doctest: +SKIP
        >>> both["monday"].torque(q, v, a)  # doctest: +SKIP
    """
    check_noise(noise)
    chosen, members, terms = _estimator(estimator), make_groups(legs, groups), check_terms(terms)
    models = {group.name: _model(group, terms) for group in members}
    layout = Layout.of(models, own)
    if any(name in layout.names[: layout.shared] for name in members[0].leg.parameter_names):
        refuse_other_designs(members)
    assumed = Assumed(known or {}, prior if isinstance(prior, Prior) else Prior(prior or {}), nonnegative)
    assumed.check_merged(models[members[0].name])
    spread = layout.spread(assumed)
    local = [layout.assumed_by(k, spread) for k in range(len(members))]
    surveys, listen = {}, preparation is None and cutoff is None
    for group, model in zip(members, models.values(), strict=True):
        with within(group.name):
            surveys[group.name] = [survey(model, data, listen=listen) for data in group.data]
    refuse_same_recordings(surveys)
    refuse_still_groups(surveys, list(models.values()), layout.names[: layout.shared], [a.names for a in local])
    problems = []
    for group, model, of_group in zip(members, models.values(), local, strict=True):
        with within(group.name):
            way = choose_preparation(surveys[group.name], preparation, cutoff)
            refuse_dead_torques(model, surveys[group.name])
            problem = Problem(model, group.data, way, assumed=Assumed(of_group.known), room=1.0 / len(members))
            refuse_empty_joints(model, [join(triangles) for triangles in zip(*problem.groups, strict=True)])
            problem.forget()
        problems.append(problem)
    joint = JointProblem(tuple(problems), layout, spread)
    return _solve(joint, list(surveys.values()), chosen, white=noise == "white")


def _solve(
    problem: JointProblem, surveys: Sequence[Sequence[Survey]], estimator: Callable[[Stacked], Fit], *, white: bool
) -> Together:
    """Fit, and look at what is left over, group by group."""
    layout, groups = problem.layout, problem.layout.groups
    outcome = Outcome.of(problem, surveys, estimator(problem), name_of(estimator), white=white)
    fit, covariance, samples = outcome.fit, outcome.covariance, outcome.samples
    agreement = shared_agreement(problem, estimator, samples, white=white)
    left = samples_left(problem, fit.solution, fit.weights, samples)
    dofs = left.each if outcome.dofs is None else np.clip(outcome.dofs, 1.0, left.each)
    collinearity = fit.solution.collinearity
    doubts = (*fit.remarks, *collinearity.remarks(layout.names), *agreement.warnings)
    estimates = {group: outcome.estimate(k, left.groups[k], dofs, doubts) for k, group in enumerate(groups)}
    return Together(
        estimates=estimates,
        layout=layout,
        values=fit.solution.values,
        covariance=covariance,
        dofs=dofs,
        sizes=judge_sizes(problem.triangles),
        calm_sizes=_smallest(layout, outcome.calm_sizes),
        collinearity=collinearity.indices,
        condition_number=fit.solution.condition_number,
        assumed=problem.assumed,
        equal=own_equality(layout, fit.solution.values, covariance, dofs),
        agreement=agreement.equality,
        bounded=tuple(problem.names[k] for k in fit.solution.bounded),
        warnings=(*doubts, *_of_groups(estimates, len(doubts))),
        notes=(*_merged(problem), *agreement.notes),
    )


def _smallest(layout: Layout, of_groups: Sequence[FloatArray]) -> FloatArray:
    """Smallest number that any group has for each parameter, (P,)."""
    smallest = np.full(len(layout.names), np.inf)
    for places, numbers in zip(layout.places, of_groups, strict=True):
        smallest[places] = np.minimum(smallest[places], numbers)
    return smallest


def _of_groups(estimates: Mapping[str, Estimate], common: int) -> tuple[str, ...]:
    """Warnings of single groups, behind those that they have in common."""
    return tuple(f"{group}: {text}" for group, estimate in estimates.items() for text in estimate.warnings[common:])


def _merged(problem: JointProblem) -> tuple[str, ...]:
    """Say what is part of other parameters, and therefore shared if these are."""
    apart = set(problem.names if len(problem.problems) < 2 else problem.layout.own)
    return tuple(
        f"{merged}" + ("" if set(merged.into) <= apart else ", and so the same in all groups")
        for merged in problem.problems[0].model.merged
    )


def _estimator(given: str | Estimator) -> Callable[[Stacked], Fit]:
    """Look an estimator up that weighs rows.

    Raises:
        ExoidError: It is another.
    """
    names = [name for name, estimator in POINTWISE.items() if given in (name, estimator)]
    if not names:
        found = find_estimator(given)
        what = f"estimator {name_of(found)!r} is for one leg alone"
        raise ExoidError(what, remedy=f"use one of {', '.join(POINTWISE)}")
    return POINTWISE[names[0]]


def _model(group: Group, terms: Sequence[Term]) -> TorqueModel:
    """Model of a group.

    Raises:
        ExoidError: It would not be linear in its parameters, or a term does not fit the leg.
    """
    with within(group.name):
        free = [shape.name for shape in free_shapes(terms, group.leg.joint_names, group.leg.joint_labels)]
        loaded = [type(term).__name__ for term in terms if term.loaded]
        if free or loaded:
            raise ExoidError(
                f"{', '.join((*free, *loaded))}: several groups are fitted together only where torque is linear in all "
                "parameters",
                remedy="give settings numbers, such as those that exoid.identify finds, and leave LoadFriction out",
            )
        return TorqueModel(group.leg, tuple(terms))
