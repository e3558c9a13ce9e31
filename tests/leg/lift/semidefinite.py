"""The lift as semidefinite programs: an oracle of another kind."""

from typing import NamedTuple

import cvxpy as cp
import numpy as np

from exoid.leg.lift.pseudo_inertia import COORDINATES, link_parameters, pseudo_inertias, upper_factors
from exoid.leg.model import dynamic_parameters


class Optimum(NamedTuple):
    """An optimal value, and the link parameters (10 n,) where it is taken."""

    value: float
    links: np.ndarray


class Bodies:
    """Positive semidefinite bodies of a leg, scaled by its own: P = U Q Uᵀ."""

    def __init__(self, leg):
        self.leg = leg
        self.factors = upper_factors(pseudo_inertias(dynamic_parameters(leg.model)))
        self.scaled = [cp.Variable((4, 4), PSD=True) for _ in self.factors]
        links = [COORDINATES @ cp.vec(U @ Q @ U.T, order="C") for U, Q in zip(self.factors, self.scaled, strict=True)]
        self.values = leg.reduction.collect @ cp.hstack(links)
        self.masses = [U[3, 3] ** 2 * Q[3, 3] for U, Q in zip(self.factors, self.scaled, strict=True)]

    def solve(self, objective, constraints=()):
        problem = cp.Problem(objective, list(constraints))
        problem.solve(cp.CLARABEL)
        if problem.status not in ("optimal", "optimal_inaccurate"):
            return None
        P = np.array([U @ Q.value @ U.T for U, Q in zip(self.factors, self.scaled, strict=True)])
        return Optimum(float(problem.value), link_parameters(P))


def nearest_to_prior(leg, values):
    """Least entropic divergence of bodies with exactly these base parameters."""
    bodies = Bodies(leg)
    divergence = sum(cp.trace(Q) - cp.log_det(Q) - 4 for Q in bodies.scaled)
    scale = np.abs(leg.parameters).max()
    return bodies.solve(cp.Minimize(divergence), [bodies.values / scale == values / scale])


def nearest_to_estimate(leg, values, covariance, heaviest):
    """Least distance, in standard deviations, of the parameters of bodies up to so many kilograms."""
    bodies = Bodies(leg)
    W = np.linalg.inv(np.linalg.cholesky(covariance))
    lighter = [mass <= most for mass, most in zip(bodies.masses, heaviest, strict=True)]
    return bodies.solve(cp.Minimize(cp.norm(W @ values - W @ bodies.values)), lighter)


def nearest_with_pull(leg, values, covariance, pull):
    """Least χ²/2 + pull · D."""
    bodies = Bodies(leg)
    W = np.linalg.inv(np.linalg.cholesky(covariance))
    divergence = sum(cp.trace(Q) - cp.log_det(Q) - 4 for Q in bodies.scaled)
    return bodies.solve(cp.Minimize(cp.sum_squares(W @ values - W @ bodies.values) / 2 + pull * divergence))


def mass_range(leg, values, first):
    """Least and largest mass of the links from ``first`` on; None where no bodies have the values."""
    bodies = Bodies(leg)
    mass = sum(bodies.masses[first:])
    same = [bodies.values == values]
    least, most = (bodies.solve(kind(mass), same) for kind in (cp.Minimize, cp.Maximize))
    return (None if least is None else least.value), (np.inf if most is None else most.value)
