"""Bodies nearest to the leg's own: Newton's method for the convex problem of the lift.

D + χ²/2μ, with −Σ log(1 − m/m_max) where masses are bounded, is minimised in coordinates in which the current bodies
are unit matrices. Iterates P = U Uᵀ, with U triangular as in the log-Cholesky parameterisation (C. Rucker,
P. M. Wensing, IEEE RA-L 7(2), 2022), stay consistent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.leg.reduction.reduction import Reduction

from .pseudo_inertia import BASIS, congruence, link_parameters, pseudo_inertias, upper_factors

PENALTIES = 10.0 ** -np.arange(11)
"""μ of the successive problems; the remaining error of the last one is corrected exactly."""

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


@dataclass(frozen=True, eq=False)
class Problem:
    """The lift in coordinates in which the prior of every link is the unit matrix: P = U⁰ P̃ U⁰ᵀ."""

    K: FloatArray  # matrix from π̃ to base parameters, (p, 10 n)
    back: FloatArray  # matrix from π̃ to π, (10 n, 10 n)
    links: int  # number of links, n

    @classmethod
    def around(cls, prior: FloatArray, reduction: Reduction) -> Problem:
        """Scale by the prior, (10 n,)."""
        blocks = congruence(upper_factors(pseudo_inertias(prior)))
        back = np.asarray(scipy.linalg.block_diag(*blocks))
        return cls(reduction.collect @ back, back, len(blocks))

    @property
    def prior(self) -> FloatArray:
        """Factors of the prior: unit matrices, (n, 4, 4)."""
        return np.tile(np.eye(4), (self.links, 1, 1))

    def minimise(self, U: FloatArray, misfit: Misfit) -> FloatArray:
        """Minimise D + misfit by damped Newton steps from bodies with factors U, (n, 4, 4)."""
        best = self._objective(U, misfit)
        for _ in range(STEPS):
            Y, gain = self._newton_step(U, misfit)
            if gain < SETTLED * (1.0 + best):
                break
            # 1 + length · Y is consistent while length · nearest > −1
            nearest = float(np.linalg.eigvalsh(Y)[:, 0].min())
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

    def _newton_step(self, U: FloatArray, misfit: Misfit) -> tuple[FloatArray, float]:
        """Newton step P ← U (1 + Y) Uᵀ, (n, 4, 4), and its predicted decrease of the objective."""
        # In an orthonormal basis of Y the second derivative of −log det is 1, even close to the boundary. The second
        # derivative of the misfit has rank p.
        turned = congruence(U) @ ORTHONORMAL
        pull = np.ravel(TRACE @ ORTHONORMAL - TRACE @ turned)
        WK = misfit.W @ self.K / np.sqrt(misfit.mu)
        columns = np.hstack(list(WK.reshape(len(WK), -1, 10).transpose(1, 0, 2) @ turned))
        residual = misfit.W @ (misfit.target - self.K @ _unit(U)) / np.sqrt(misfit.mu)
        if misfit.heaviest is not None:  # −log room, whose second derivative has one row per link
            room = misfit.heaviest - U[:, 3, 3] ** 2
            each = np.eye(len(room))[:, :, None] * (turned[:, 0] / room[:, None])  # block_diag is 20 times as slow
            columns = np.vstack([columns, each.reshape(len(room), -1)])
            residual = np.concatenate([residual, -np.ones(len(room))])
        small = np.eye(len(columns)) + columns @ columns.T
        y = pull + columns.T @ np.linalg.solve(small, residual - columns @ pull)
        gain = 0.5 * float((pull + columns.T @ residual) @ y)
        return pseudo_inertias(y.reshape(-1, 10) @ ORTHONORMAL.T), gain

    def _objective(self, U: FloatArray, misfit: Misfit) -> float:
        share = np.zeros(1) if misfit.heaviest is None else U[:, 3, 3] ** 2 / misfit.heaviest
        if share.max() >= 1.0:
            return np.inf
        residual = misfit.W @ (misfit.target - self.K @ _unit(U))
        return _divergence(U) - float(np.log1p(-share).sum()) + float(residual @ residual) / (2.0 * misfit.mu)


class Misfit(NamedTuple):
    """Penalty ‖W (β − K π̃)‖² / 2μ, and −log(1 − m / heaviest m⁰) of each link."""

    W: FloatArray
    target: FloatArray
    mu: float
    heaviest: FloatArray | None = None


class Bodies(NamedTuple):
    """Solution of the lift."""

    unit: FloatArray  # π̃ of the bodies, (10 n,)
    divergence: float  # divergence D from the prior


def reproduce(
    problem: Problem, target: FloatArray, natural: FloatArray, heaviest: FloatArray, *, bounded: bool
) -> Bodies | None:
    """Find the bodies nearest to the prior that have the target's values exactly; None if there are none."""
    # `natural` whitens the change of β by the relative change of inertias, `heaviest` is over the masses of the prior,
    # and `bounded` looks for other bodies where the nearest are too heavy.
    unit, heavy = _exact(problem, target, natural, heaviest, None)
    if heavy and bounded:
        unit, heavy = _exact(problem, target, natural, heaviest, heaviest)
    return None if unit is None or heavy else Bodies(unit, _divergence(upper_factors(pseudo_inertias(unit))))


def _exact(
    problem: Problem, target: FloatArray, natural: FloatArray, heaviest: FloatArray, bound: FloatArray | None
) -> tuple[FloatArray | None, bool]:
    """π̃ of the bodies with the target's values, (10 n,), None if none are consistent; and whether one is too heavy."""
    U, smallest_change = problem.prior, np.linalg.pinv(natural @ problem.K) @ natural
    for mu in PENALTIES:
        U = problem.minimise(U, Misfit(natural, target, mu, bound))
        unit = _unit(U)
        unit = unit + smallest_change @ (target - problem.K @ unit)
        # Smallest eigenvalue of P, relative to the prior, of a body that is not on the boundary of the
        # consistent set
        consistent = np.linalg.eigvalsh(pseudo_inertias(unit)).min() > 1e-8
        heavy = bool((U[:, 3, 3] ** 2 > heaviest).any())
        # Value of μ from which on the corrected bodies of a feasible estimate are consistent
        if heavy or (not consistent and mu <= 1e-7):
            return None, heavy
    return unit, bool((unit[::10] > heaviest).any())


def approach(
    problem: Problem,
    target: FloatArray,
    metric: FloatArray,
    heaviest: FloatArray,
    pull: float = 0.0,
    enough: float = 0.0,
) -> Bodies:
    """Find the bodies whose values are nearest to the target in a metric, or those of least χ²/2 + w D."""
    U, gap = problem.prior, 0.1 if enough else GAP  # where others are enough, the nearest need not be exact
    chi_squared = _chi_squared(problem, target, metric, U)
    mu = max(chi_squared, 10.0 * pull)
    while mu > pull if pull else (4 * problem.links + heaviest.sum()) * mu > max(gap * chi_squared, NEGLIGIBLE):
        if chi_squared <= enough**2:
            break
        mu = max(mu / 10.0, pull)
        U = problem.minimise(U, Misfit(metric, target, mu, None if pull else heaviest))
        chi_squared = _chi_squared(problem, target, metric, U)
    # Smallest eigenvalue of P̃ of an infeasible estimate's body over its largest: thinner ones are lost to
    # rounding, and get a share of the prior's inertia
    P = U @ U.transpose(0, 2, 1)
    eigenvalues = np.linalg.eigvalsh(P)
    lacking = np.maximum(1e-10 * eigenvalues[:, -1] - eigenvalues[:, 0], 0.0)
    return Bodies(link_parameters(P + lacking[:, None, None] * np.eye(4)), _divergence(U))


def _chi_squared(problem: Problem, target: FloatArray, metric: FloatArray, U: FloatArray) -> float:
    return float(np.sum((metric @ (target - problem.K @ _unit(U))) ** 2))


def _unit(U: FloatArray) -> FloatArray:
    """π̃ of the bodies U Uᵀ, (10 n,)."""
    return link_parameters(U @ U.transpose(0, 2, 1))


def _divergence(U: FloatArray) -> float:
    """Divergence D of the bodies U Uᵀ from unit matrices."""
    return float(np.sum(U**2) - 2.0 * np.log(np.diagonal(U, axis1=1, axis2=2)).sum() - 4 * len(U))
