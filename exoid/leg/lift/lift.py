"""Lift: physically consistent links with given base parameters.

Base parameters β = K π do not determine the link parameters π. Of all bodies with P ≻ 0 that reproduce β, the lift
selects those nearest to the leg's own inertias P⁰ by the entropic divergence (T. Lee, P. M. Wensing, F. C. Park,
IEEE T-RO 36(2), 2020)

    D(P ‖ P⁰) = Σ_links tr(P⁰⁻¹ P) − log det(P⁰⁻¹ P) − 4.

D is convex in π, invariant to units and frames, zero only at P⁰, and unbounded towards inconsistent bodies. If no
consistent bodies reproduce β, the lift selects those whose parameters are nearest to β in the metric of the estimate,
χ² = (β − K π)ᵀ C⁻¹ (β − K π).

Both are limits of one smooth convex problem, D + χ²/2μ with μ → 0, which :mod:`exoid.leg.lift.nearest_bodies` solves.
Minimising over log-Cholesky coordinates finds the same bodies for a feasible estimate, as the tests check. For an
infeasible one the minimum is on the boundary, at infinity in these coordinates, which takes hundreds of steps.

The nearest parameters may belong to links that are hundreds of times too heavy. A pull w > 0 towards the leg's own
links selects the bodies with the least χ²/2 + w D instead. A change of all inertias of a link by a share ε has
D ≈ 2 ε². So w = 1 believes the leg's own inertias as if their standard deviation were 50 % of their values. Parameters
that the estimate determines well hardly move by the pull; those that it does not go to the leg's own.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, NotIdentifiableError
from exoid.leg.leg import Leg
from exoid.tools.numbers import checked
from exoid.tools.read_only import ReadOnly

from .nearest_bodies import Problem, approach, reproduce
from .pseudo_inertia import make_consistent

HEAVIEST = 10.0
"""Largest mass of a link over its mass in the URDF, which is first scaled up if all inertias there are too small.

Without this bound the nearest consistent estimate often has links of infinite mass.
"""

PULL = 1.0
"""Usual pull towards the leg's own links: as if their inertias had standard deviations of 50 %."""

ABSURD = 1e12
"""Smallest base parameter that no leg has, over its change by a change of the links' inertias by 100 %."""

FLOOR = 1e-12
"""Smallest standard deviation of a base parameter, relative to the change that the prior allows."""


@dataclass(frozen=True, eq=False, repr=False)
class Lift(ReadOnly):
    """Physically consistent links, and the base parameters that they reproduce.

    Attributes:
        names: Names of the base parameters, (p,).
        values: Values of the links, (p,); those that were requested if they are feasible.
        links: Names of the moving links, (k,), behind the root link if the base floats.
        link_parameters: π of each link with the links fixed to it, about its joint frame, (k, 10), in the order of
            Pinocchio: m, mc, I.
        feasible: Whether consistent links have the requested values.
        distance: Distance χ of ``values`` from these in standard deviations of the estimate; 0 if feasible.
            Without a covariance its unit is a change of the links' inertias by 100 %.
        divergence: Entropic divergence from the leg's own links; 0 if these have the requested values.
        mass_limits: Largest mass that each link was allowed [kg], (k,); infinite with a pull, which keeps them near.
    """

    names: tuple[str, ...]
    values: FloatArray
    links: tuple[str, ...]
    link_parameters: FloatArray
    feasible: bool
    distance: float
    divergence: float
    mass_limits: FloatArray

    def __repr__(self) -> str:
        """Write one line."""
        return f"Lift(feasible={self.feasible}, distance={self.distance:.3g}, divergence={self.divergence:.3g})"


@contextmanager
def _in_range() -> Iterator[None]:
    """Turn numbers that no arithmetic can hold into an error about the estimate."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # the result is checked
            yield
    except (np.linalg.LinAlgError, ValueError) as error:
        raise NotIdentifiableError(
            f"no links can be found for these parameters ({error}): they are far from those of a leg",
            remedy="check the estimate: its units, its standard deviations and its warnings",
        ) from error


@_in_range()
def lift(
    leg: Leg,
    values: ArrayLike,
    covariance: ArrayLike | None = None,
    *,
    pull: float = 0.0,
    mass_factor: float | None = None,
) -> Lift:
    """Find the physically consistent links with these base parameters that are nearest to the leg's own.

    Args:
        leg: The leg; its inertias are the prior. Links without a mass distribution (point masses, rods) first get a
            small extent, see :func:`exoid.leg.lift.pseudo_inertia.make_consistent`.
        values: Base parameters, (p,), in the order of ``leg.parameter_names``.
        covariance: Covariance of the values, (p, p), which is the metric if they are not feasible. None for a metric
            that measures a change by the relative change of the links' inertias.
        pull: Weight w of the divergence from the leg's own links where no consistent links have the values, at least
            zero; :data:`PULL` is usual. Feasible values are reproduced exactly, whatever the pull.
        mass_factor: Largest mass of a link over its mass in the URDF in a feasible lift, above 1, and largest mass
            in the URDF over it; None for :data:`HEAVIEST`, scaled up if all inertias in the URDF are too small, and for
            no lower bound.

    Returns:
        The links. Each pseudo-inertia is positive definite, so masses and principal inertias are positive and the
        triangle inequalities hold strictly. An estimate on the boundary of the consistent set, with a body thinner than
        about 1e-8 of the prior, counts as infeasible. So does an estimate whose links exceed the mass factor.

    Raises:
        ExoidError: Values or covariance do not fit the leg, are not finite or absurd, the covariance has a negative
            eigenvalue, or pull or mass factor are out of range.

    Example:
        >>> leg = exoid.load_leg("bleex")
        >>> lifted = lift(leg, 1.1 * leg.parameters)
        >>> lifted.feasible, bool(np.allclose(lifted.values, 1.1 * leg.parameters, rtol=1e-12))
        (True, True)
    """
    target = fitting(leg, values)
    if not pull >= 0.0 or not (mass_factor is None or mass_factor > 1.0):
        raise BadArgumentError(
            f"pull {pull} and mass factor {mass_factor} are out of range",
            remedy="a pull is zero or positive, a mass factor above 1",
        )
    prior, problem = _problem(leg, target)
    natural = _whitening(problem.K @ problem.K.T)
    usual = _usual_mass(natural @ leg.reduction.parameters(prior), natural @ target)
    heaviest = np.full(problem.links, usual if mass_factor is None else min(mass_factor, ABSURD))
    found, distance = reproduce(problem, target, natural, heaviest, bounded=mass_factor is not None), 0.0
    if found is not None and mass_factor is not None and (found.unit[::10] < 1.0 / mass_factor).any():
        found = None
    feasible = found is not None
    if found is None:
        metric = natural if covariance is None else _metric(fitting(leg, covariance, "covariance", 2), problem)
        heaviest = np.full(problem.links, np.inf if pull else max(float(heaviest[0]), usual))
        found = approach(problem, target, metric, heaviest, pull)
        distance = float(np.linalg.norm(metric @ (target - problem.K @ found.unit)))
    links = problem.back @ found.unit
    if feasible:
        links = links + leg.reduction.spread @ (target - leg.reduction.collect @ links)  # the last rounding error
    if not np.isfinite(links).all():
        raise np.linalg.LinAlgError("the numbers overflow")
    return Lift(
        names=leg.parameter_names,
        values=leg.reduction.parameters(links),
        links=leg.bodies,
        link_parameters=links.reshape(-1, 10),
        feasible=feasible,
        distance=distance,
        divergence=found.divergence,
        mass_limits=heaviest * prior[::10],
    )


@_in_range()
def nearest_within(leg: Leg, values: ArrayLike, covariance: ArrayLike, distance: float) -> tuple[FloatArray, float]:
    """Find values of some consistent links within a distance, or else of the nearest, whose distance is 5 % too far."""
    # This costs less than `lift`, which tries to reproduce the values first, and then finds the nearest exactly.
    target = fitting(leg, values)
    prior, problem = _problem(leg, target)
    metric = _metric(fitting(leg, covariance, "covariance", 2), problem)
    natural = _whitening(problem.K @ problem.K.T)
    heaviest = _usual_mass(natural @ leg.reduction.parameters(prior), natural @ target)
    found = problem.K @ approach(problem, target, metric, np.full(problem.links, heaviest), enough=distance).unit
    return found, float(np.linalg.norm(metric @ (target - found)))


def _usual_mass(own: FloatArray, target: FloatArray) -> float:
    """Bound of a link's mass over that in the URDF, from whitened values of the URDF and the target."""
    return HEAVIEST * max(1.0, float(own @ target) / float(own @ own))


def _problem(leg: Leg, target: FloatArray) -> tuple[FloatArray, Problem]:
    """The leg's own links, made consistent, and the problem around them; values whose squares overflow are refused."""
    prior = make_consistent(leg.link_parameters)
    problem = Problem.around(prior, leg.reduction)
    absurd = np.abs(target) > ABSURD * np.linalg.norm(problem.K, axis=1)
    if absurd.any():
        what = ", ".join(
            f"{name} = {value:.3g}"
            for name, value, wrong in zip(leg.parameter_names, target, absurd, strict=True)
            if wrong
        )
        raise NotIdentifiableError(
            f"no leg has {what}", where=leg.description.name, remedy="identify from a motion that determines it"
        )
    return prior, problem


def _whitening(covariance: FloatArray) -> FloatArray:
    """W with Wᵀ W = covariance⁻¹, (p, p)."""
    scale = np.sqrt(np.diag(covariance))
    lower = np.linalg.cholesky(covariance / np.outer(scale, scale))
    return np.asarray(scipy.linalg.solve_triangular(lower, np.diag(1.0 / scale), lower=True))


def _metric(covariance: FloatArray, problem: Problem) -> FloatArray:
    """Whitening matrix of an estimate's covariance, with a floor for directions that are known exactly."""
    scale = np.linalg.norm(problem.K, axis=1)
    values, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    if values[0] < -1e-9 * max(values[-1], FLOOR):
        raise BadArgumentError(
            f"the covariance has a negative eigenvalue ({values[0]:.2g} relative)", remedy="pass est.covariance"
        )
    return np.asarray((axes / np.sqrt(np.maximum(values, FLOOR**2))).T / scale)


def fitting(leg: Leg, given: ArrayLike, name: str = "values", dimensions: int = 1) -> FloatArray:
    """Check that base parameters, or their covariance, fit a leg."""
    array, shape = checked(given, name, ndim=dimensions), (len(leg.parameter_names),) * dimensions
    if array.shape != shape:
        raise BadArgumentError(
            f"{name} of shape {array.shape} do not fit",
            where=leg.description.name,
            remedy=f"pass numbers of shape {shape}, in the order {', '.join(leg.parameter_names)}",
        )
    return array
