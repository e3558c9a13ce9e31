"""Lift: physically consistent links with given base parameters.

Base parameters β = K π do not determine the link parameters π. Of all bodies with P ≻ 0 that reproduce β, the lift
selects those nearest to the leg's own inertias P⁰ by the entropic divergence (T. Lee, P. M. Wensing, F. C. Park,
IEEE T-RO 36(2), 2020)

    D(P ‖ P⁰) = Σ_links tr(P⁰⁻¹ P) − log det(P⁰⁻¹ P) − 4.

D is convex in π, invariant to units and frames, zero only at P⁰, and unbounded towards inconsistent bodies. If no
consistent bodies reproduce β, the lift selects those whose parameters are nearest to β in the metric of the estimate,
χ² = (β − K π)ᵀ C⁻¹ (β − K π).

Both are limits of one smooth convex problem, D + χ²/2μ with μ → 0. Newton's method solves it in coordinates in which
the current bodies are unit matrices. Its iterates P = U Uᵀ, with U triangular as in the log-Cholesky parameterisation
(C. Rucker, P. M. Wensing, IEEE RA-L 7(2), 2022), stay consistent. Minimising over the log-Cholesky coordinates finds
the same bodies for a feasible estimate, as the tests check. For an infeasible one the minimum is on the boundary, at
infinity in these coordinates, which takes hundreds of steps.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.model import dynamic_parameters
from exoid.reduction.reduction import LINK_PARAMETERS, LINK_UNITS, Reduction
from exoid.tables import make_table, to_text

from .pseudo_inertia import BASIS, congruence, link_parameters, make_consistent, pseudo_inertias, upper_factors

PENALTIES = 10.0 ** -np.arange(11)
"""μ of the successive problems; the remaining error of the last one is corrected exactly."""

FEASIBLE_MU = 1e-7
"""Value of μ from which on the corrected bodies of a feasible estimate are consistent."""

TIGHTEST = 1e-8
"""Smallest eigenvalue of P, relative to the prior, of a body that is not on the boundary of the consistent set."""

HEAVIEST = 10.0
"""Largest mass of a link over its mass in the URDF, which is first scaled up if all inertias there are too small.

Without this bound the nearest consistent estimate often has links of infinite mass.
"""

GAP = 1e-5
"""Tolerance of the smallest χ² of an infeasible estimate, relative."""

NEGLIGIBLE = 1e-9
"""Tolerance of the smallest χ², absolute."""

STEPS = 300
"""Largest number of Newton steps for each μ; a dozen is usual."""

SETTLED = 1e-12
"""Half the squared Newton decrement at which a problem counts as solved."""

LONGEST = 0.95
"""Largest step, as a fraction of the distance to the boundary of the consistent set."""

TRACE = np.trace(BASIS, axis1=1, axis2=2)
"""tr P = TRACE · π."""

ORTHONORMAL = np.linalg.inv(np.linalg.cholesky(BASIS.reshape(10, 16) @ BASIS.reshape(10, 16).T).T)
"""π of matrices that are orthonormal under ⟨A, B⟩ = tr A B, as columns, (10, 10)."""

FLOOR = 1e-12
"""Smallest standard deviation of a base parameter, relative to the change that the prior allows."""


@dataclass(frozen=True, eq=False, repr=False)
class Lift:
    """Physically consistent links, and the base parameters that they reproduce; ``print`` shows them.

    Attributes:
        names: Names of the base parameters, (p,).
        target: Requested values, (p,).
        values: Values of the links, (p,); equal to the target if it is feasible.
        links: Names of the moving links, (n,).
        link_parameters: π of each link with the links fixed to it, about its joint frame, (n, 10), in the order of
            :data:`exoid.reduction.LINK_PARAMETERS`.
        feasible: Whether consistent links have the target's values.
        distance: Distance χ of ``values`` from the target in standard deviations of the estimate; 0 if feasible.
            Without a covariance its unit is a change of the links' inertias by 100 %.
        divergence: Entropic divergence from the leg's own links; 0 if these have the target's values.
        mass_limits: Largest mass that each link was allowed [kg], (n,).
    """

    names: tuple[str, ...]
    target: FloatArray
    values: FloatArray
    links: tuple[str, ...]
    link_parameters: FloatArray
    feasible: bool
    distance: float
    divergence: float
    mass_limits: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for array in (self.target, self.values, self.link_parameters, self.mass_limits):
            array.flags.writeable = False

    @property
    def moved(self) -> dict[str, float]:
        """Change of each parameter that made it consistent; empty if feasible."""
        if self.feasible:
            return {}
        return dict(zip(self.names, (self.values - self.target).tolist(), strict=True))

    def __repr__(self) -> str:
        """Write one line."""
        return f"Lift(feasible={self.feasible}, distance={self.distance:.3g}, divergence={self.divergence:.3g})"

    def __str__(self) -> str:
        """Print the links, and the parameters that changed."""
        rows = [
            (f"{name} [{unit}]", *(f"{value:.5g}" for value in column))
            for name, unit, column in zip(LINK_PARAMETERS, LINK_UNITS, self.link_parameters.T, strict=True)
        ]
        parts = [make_table(("about the joint", *self.links), rows)]
        if self.feasible:
            return to_text("physically consistent links, with exactly the requested parameters", *parts)
        moved = [
            (name, f"{old:.5g}", f"{new:.5g}", f"{new - old:+.2g}")
            for name, old, new in zip(self.names, self.target, self.values, strict=True)
        ]
        title = f"no physically consistent links have these parameters; the nearest are {self.distance:.3g} away"
        return to_text(title, *parts, make_table(("parameter", "requested", "consistent", "change"), moved))


@contextmanager
def _in_range() -> Iterator[None]:
    """Turn numbers that no arithmetic can hold into an error about the estimate."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # the result is checked
            yield
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ExoidError(
            f"no links can be found for these parameters ({error}): they are far from those of a leg",
            remedy="check the estimate: its units, its standard deviations and its warnings",
        ) from error


@_in_range()
def lift(leg: Leg, values: ArrayLike, covariance: ArrayLike | None = None) -> Lift:
    """Find the physically consistent links with these base parameters that are nearest to the leg's own.

    Args:
        leg: The leg; its inertias are the prior. Links without a mass distribution (point masses, rods) first get a
            small extent, see :func:`exoid.lift.pseudo_inertia.make_consistent`.
        values: Base parameters, (p,), in the order of ``leg.parameter_names``.
        covariance: Covariance of the values, (p, p), which is the metric if they are not feasible. None for a metric
            that measures a change by the relative change of the links' inertias.

    Returns:
        The links. Each pseudo-inertia is positive definite, so masses and principal inertias are positive and the
        triangle inequalities hold strictly. An estimate on the boundary of the consistent set, with a body thinner than
        about 1e-8 of the prior, counts as infeasible. So does an estimate whose links exceed :data:`HEAVIEST`.

    Raises:
        ExoidError: Values or covariance do not fit the leg or are not finite, the covariance has a negative eigenvalue,
            or the values are so large that the arithmetic fails.

    Example:
        >>> leg = exoid.load_leg("bleex")
        >>> lifted = lift(leg, 1.1 * leg.parameters)
        >>> lifted.feasible, bool(np.allclose(lifted.values, 1.1 * leg.parameters, rtol=1e-12))
        (True, True)
    """
    target = checked_values(leg, values)
    prior = make_consistent(dynamic_parameters(leg.model))
    problem = _Problem.around(prior, leg.reduction)
    natural = _whitening(problem.K @ problem.K.T)
    own = natural @ leg.reduction.parameters(prior)
    scale = float(own @ natural @ target) / float(own @ own)
    heaviest = np.full(problem.links, HEAVIEST * max(1.0, scale))
    exact = _reproduce(problem, target, natural, heaviest)
    if exact is not None:
        unit, feasible = exact, True
    else:
        metric = natural if covariance is None else _metric(_checked(leg, covariance, "covariance", 2), problem)
        unit, feasible = _approach(problem, target, metric, heaviest), False
    reached = problem.K @ unit
    links = problem.back @ unit
    if feasible:
        links = links + leg.reduction.spread @ (target - leg.reduction.collect @ links)  # the last rounding error
    if not np.isfinite(links).all():
        raise np.linalg.LinAlgError("the numbers overflow")
    return Lift(
        names=leg.parameter_names,
        target=target,
        values=leg.reduction.parameters(links),
        links=leg.link_names,
        link_parameters=links.reshape(-1, 10),
        feasible=feasible,
        distance=0.0 if feasible else float(np.linalg.norm(metric @ (target - reached))),
        divergence=_divergence(upper_factors(pseudo_inertias(unit))),
        mass_limits=heaviest * prior[::10],
    )


def checked_values(leg: Leg, values: ArrayLike) -> FloatArray:
    """Check that base parameters fit a leg.

    Args:
        leg: The leg.
        values: Base parameters, (p,).

    Returns:
        The values, (p,).

    Raises:
        ExoidError: Their number is wrong, or one is not finite.
    """
    return _checked(leg, values, "values", 1)


@dataclass(frozen=True, eq=False)
class _Problem:
    """The lift in coordinates in which the prior of every link is the unit matrix: P = U⁰ P̃ U⁰ᵀ.

    Attributes:
        K: Matrix from π̃ to base parameters, (p, 10 n).
        back: Matrix from π̃ to π, (10 n, 10 n).
        links: Number of links, n.
    """

    K: FloatArray
    back: FloatArray
    links: int

    @classmethod
    def around(cls, prior: FloatArray, reduction: Reduction) -> _Problem:
        """Scale by the prior, (10 n,)."""
        blocks = congruence(upper_factors(pseudo_inertias(prior)))
        back = np.asarray(scipy.linalg.block_diag(*blocks))
        return cls(reduction.collect @ back, back, len(blocks))

    @property
    def prior(self) -> FloatArray:
        """Factors of the prior: unit matrices, (n, 4, 4)."""
        return np.tile(np.eye(4), (self.links, 1, 1))

    def minimise(self, U: FloatArray, misfit: _Misfit) -> FloatArray:
        """Minimise D + misfit by damped Newton steps from bodies with factors U, (n, 4, 4)."""
        best = self._objective(U, misfit)
        for _ in range(STEPS):
            Y, gain = self._newton_step(U, misfit)
            if gain < SETTLED * (1.0 + best):
                break
            nearest = float(
                np.linalg.eigvalsh(Y)[:, 0].min()
            )  # 1 + length · Y is consistent while length · nearest > −1
            length = min(1.0, LONGEST / max(-nearest, 1e-9))
            while True:
                trial = U @ upper_factors(np.eye(4) + length * Y)
                value = self._objective(trial, misfit)
                if value <= best - 0.1 * length * gain or length < 1e-10:
                    break
                length *= 0.5
            if value >= best:  # only rounding is left
                break
            U, best = trial, value
        return U

    def _newton_step(self, U: FloatArray, misfit: _Misfit) -> tuple[FloatArray, float]:
        """Newton step P ← U (1 + Y) Uᵀ, (n, 4, 4), and its predicted decrease of the objective.

        In an orthonormal basis of Y the second derivative of −log det is 1, even close to the boundary. The second
        derivative of the misfit has rank p.
        """
        turned = congruence(U) @ ORTHONORMAL
        pull = np.ravel(TRACE @ ORTHONORMAL - TRACE @ turned)
        WK = misfit.W @ self.K / np.sqrt(misfit.mu)
        columns = np.hstack(list(WK.reshape(len(WK), -1, 10).transpose(1, 0, 2) @ turned))
        residual = misfit.W @ (misfit.target - self.K @ _unit(U)) / np.sqrt(misfit.mu)
        if misfit.heaviest is not None:  # −log room, whose second derivative has one row per link
            room = misfit.heaviest - U[:, 3, 3] ** 2
            columns = np.vstack([columns, scipy.linalg.block_diag(*(turned[:, 0] / room[:, None]))])
            residual = np.concatenate([residual, -np.ones(len(room))])
        small = np.eye(len(columns)) + columns @ columns.T
        y = pull + columns.T @ np.linalg.solve(small, residual - columns @ pull)
        gain = 0.5 * float((pull + columns.T @ residual) @ y)
        return pseudo_inertias(y.reshape(-1, 10) @ ORTHONORMAL.T), gain

    def _objective(self, U: FloatArray, misfit: _Misfit) -> float:
        share = np.zeros(1) if misfit.heaviest is None else U[:, 3, 3] ** 2 / misfit.heaviest
        if share.max() >= 1.0:
            return np.inf
        residual = misfit.W @ (misfit.target - self.K @ _unit(U))
        return _divergence(U) - float(np.log1p(-share).sum()) + float(residual @ residual) / (2.0 * misfit.mu)


class _Misfit(NamedTuple):
    """Penalty ‖W (β − K π̃)‖² / 2μ, and −log(1 − m / heaviest m⁰) of each link."""

    W: FloatArray
    target: FloatArray
    mu: float
    heaviest: FloatArray | None = None


def _reproduce(problem: _Problem, target: FloatArray, natural: FloatArray, heaviest: FloatArray) -> FloatArray | None:
    """π̃ of the bodies nearest to the prior that have the target's values exactly, (10 n,); None if none do."""
    U, smallest_change = problem.prior, np.linalg.pinv(natural @ problem.K) @ natural
    for mu in PENALTIES:
        U = problem.minimise(U, _Misfit(natural, target, mu))
        unit = _unit(U)
        unit = unit + smallest_change @ (target - problem.K @ unit)
        consistent = np.linalg.eigvalsh(pseudo_inertias(unit)).min() > TIGHTEST
        if (U[:, 3, 3] ** 2 > heaviest).any() or (not consistent and mu <= FEASIBLE_MU):
            return None
    return unit


def _approach(problem: _Problem, target: FloatArray, metric: FloatArray, heaviest: FloatArray) -> FloatArray:
    """π̃ of the bodies whose values are nearest to the target in a metric, to within :data:`GAP`, (10 n,)."""
    U = problem.prior
    chi_squared = mu = _chi_squared(problem, target, metric, U)
    while (4 * problem.links + heaviest.sum()) * mu > max(GAP * chi_squared, NEGLIGIBLE):
        mu /= 10.0
        U = problem.minimise(U, _Misfit(metric, target, mu, heaviest))
        chi_squared = _chi_squared(problem, target, metric, U)
    return _unit(U)


def _chi_squared(problem: _Problem, target: FloatArray, metric: FloatArray, U: FloatArray) -> float:
    return float(np.sum((metric @ (target - problem.K @ _unit(U))) ** 2))


def _unit(U: FloatArray) -> FloatArray:
    """π̃ of the bodies U Uᵀ, (10 n,)."""
    return link_parameters(U @ U.transpose(0, 2, 1))


def _divergence(U: FloatArray) -> float:
    """Divergence D of the bodies U Uᵀ from unit matrices."""
    return float(np.sum(U**2) - 2.0 * np.log(np.diagonal(U, axis1=1, axis2=2)).sum() - 4 * len(U))


def _whitening(covariance: FloatArray) -> FloatArray:
    """W with Wᵀ W = covariance⁻¹, (p, p)."""
    scale = np.sqrt(np.diag(covariance))
    lower = np.linalg.cholesky(covariance / np.outer(scale, scale))
    return np.asarray(scipy.linalg.solve_triangular(lower, np.diag(1.0 / scale), lower=True))


def _metric(covariance: FloatArray, problem: _Problem) -> FloatArray:
    """Whitening matrix of an estimate's covariance, with a floor for directions that are known exactly."""
    scale = np.linalg.norm(problem.K, axis=1)
    values, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    if values[0] < -1e-9 * max(values[-1], FLOOR):
        raise ExoidError(
            f"the covariance has a negative eigenvalue ({values[0]:.2g} relative)", remedy="pass est.covariance"
        )
    return np.asarray((axes / np.sqrt(np.maximum(values, FLOOR**2))).T / scale)


def _checked(leg: Leg, given: ArrayLike, name: str, dimensions: int) -> FloatArray:
    shape = (len(leg.parameter_names),) * dimensions
    try:
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ExoidError(f"{name} are not numbers ({error})", remedy=f"pass an array of shape {shape}") from error
    if array.shape != shape or not np.isfinite(array).all():
        raise ExoidError(
            f"{name} of shape {array.shape} do not fit, or are not finite",
            where=leg.description.name,
            remedy=f"pass finite numbers of shape {shape}, in the order {', '.join(leg.parameter_names)}",
        )
    return array
