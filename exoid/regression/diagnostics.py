"""Diagnostics: noise of the residuals, scale and identifiability of parameters, collinearity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .least_squares import TINY, RFactor, Solution
from .model import RegressorModel
from .noise import autocovariance_sums
from .parameters import PriorKnowledge
from .problem import Fit, Noises, RowProblem
from .residuals import series

WELL = 0.1
"""Largest standard deviation of a well determined parameter, over its size."""

WEAKLY = 0.3
"""That of a weakly determined one; beyond, it is not determined."""

SIZE = 0.1
"""A value near zero is judged by this part of the value that would explain all torque of a joint alone."""

LAGS = 10
"""Autocorrelations that are tested for whiteness."""

ILL_CONDITIONED = 100.0
"""Condition index beyond which an error of a thousandth of the torque may grow to a tenth of that of a parameter."""

HOPELESS = 300.0
"""That beyond which it may grow to a third."""

OTHER, MOST = 0.2, 0.5
"""Logarithm of a factor from which on it is another scale, and least part of the squared residuals of a row that it
explains, and of the rows that have it."""


class Collinearity(NamedTuple):
    """What a least-squares problem says on parameters that it can hardly tell apart."""

    # condition index of each parameter: at least half of its variance comes from directions of this index or
    # worse, (P,); 1 for known parameters
    indices: FloatArray = np.ones(0)
    # directions beyond `ILL_CONDITIONED`, the worst first: condition index, the largest singular value of the
    # unit-column regressor over its own, and indices of parameters whose columns nearly cancel, the most involved first
    directions: tuple[tuple[float, tuple[int, ...]], ...] = ()

    @classmethod
    def of(cls, solution: Solution) -> Collinearity:
        """Look at the singular value decomposition of a unit-column regressor."""
        # With singular values σ_k and right vectors v_k a parameter's variance is Σ_k v_ik² / σ_k²: each term over the
        # sum is the variance-decomposition proportion of direction k.
        sigma, places = solution.sigma, solution.free
        worst_first, columns = np.minimum(sigma[0] / sigma[::-1], 1e100), solution.Vt[::-1]
        parts = (columns * worst_first[:, None]) ** 2
        summed = np.cumsum(parts, axis=0) / np.maximum(parts.sum(axis=0), np.finfo(np.float64).tiny)
        indices = np.ones(len(solution.values))
        # A parameter belongs to the directions that make up this part of its variance
        indices[places] = worst_first[np.argmax(summed >= 0.5, axis=0)]
        directions = []
        for index, direction in zip(worst_first, np.abs(columns), strict=True):
            if index <= ILL_CONDITIONED:
                break
            order = np.argsort(-direction)
            # A column with at least this part in a direction is named with it
            named = [int(places[k]) for k in order if direction[k] >= 0.2]
            directions.append((float(index), tuple(named)))
        return cls(indices, tuple(directions))

    def warnings(self, names: Sequence[str]) -> tuple[str, ...]:
        """Name the parameters that move together, three groups of them at most, in one sentence."""
        groups = [
            f"{', '.join(names[k] for k in columns)} (condition index {index:.3g})"
            for index, columns in self.directions
        ]
        if not groups:
            return ()
        more = f"; and {len(groups) - 3} other groups" if len(groups) > 3 else ""
        return (
            f"these recordings hardly tell apart {'; '.join(groups[:3])}{more}: small errors of model, sensors or "
            "filters move them together by much, so excite more, or plan a motion",
        )


def condition_number(inverse: FloatArray, places: NDArray[np.intp]) -> float:
    """Condition number of some parameters' scaled regressor, the columns of all others projected out."""
    free = places[np.diag(inverse)[places] > 0.0]
    information = np.linalg.inv(_scaled(inverse[np.ix_(free, free)]))
    sizes = np.linalg.eigvalsh(_scaled(np.asarray(information, dtype=np.float64)))
    return float(np.sqrt(sizes[-1] / max(sizes[0], np.finfo(float).eps)))


def _scaled(matrix: FloatArray) -> FloatArray:
    """Scale rows and columns so that the diagonal is 1."""
    scale = np.sqrt(np.diag(matrix))
    return np.asarray(matrix / np.multiply.outer(scale, scale))


@dataclass(frozen=True)
class JointNoise:
    """Noise of the residuals of one joint.

    Attributes:
        samples: Number of rows, decimated until they are independent behind the filter.
        effective_samples: Independent samples that say as much on the size of the noise, N γ_0² / Σ γ_k².
        order: Order of the autoregressive noise model, the largest of all recordings.
        correlation: Correlation of one residual with the next.
        whiteness: Probability of autocorrelations as large as these in white noise (Ljung and Box); below 0.05 the
            residuals are not white, which intervals account for.
    """

    samples: int
    effective_samples: float
    order: int
    correlation: float
    whiteness: float


def describe_noise(problem: RowProblem, fit: Fit, noises: Noises) -> tuple[JointNoise, ...]:
    """Describe the residuals of each joint."""
    joints = len(problem.columns)
    samples, effective, statistic, lags = np.zeros((4, joints))
    products = np.zeros((joints, 2))
    for part in (part for parts in series(problem, fit) for part in parts):
        joint, pairs = part.joint, np.rint(autocovariance_sums(part.usable, LAGS))
        samples[joint] += pairs[0]
        effective[joint] += pairs[0] * noises[part.kind, joint].effective_share
        sums = autocovariance_sums(part.residual, LAGS)
        if not part.kind.at_rest and pairs[0] > 2 * LAGS and sums[0] > 0.0:
            correlations = sums[1:] / np.maximum(pairs[1:], 1.0) * pairs[0] / sums[0]
            statistic[joint] += (pairs[1:] * correlations**2).sum()
            lags[joint] += LAGS
            products[joint] += sums[:2]
    return tuple(
        JointNoise(
            samples=int(samples[joint]),
            effective_samples=float(effective[joint]),
            order=max(noise.order for (_, j), noise in noises.items() if j == joint),
            correlation=float(products[joint, 1] / (products[joint, 0] or 1.0)),
            whiteness=float(scipy.stats.chi2.sf(statistic[joint], lags[joint])) if lags[joint] else 1.0,
        )
        for joint in range(joints)
    )


def short_runs(noises: Noises, joint_names: Sequence[str]) -> tuple[str, ...]:
    """Warn of joints whose recordings or segments are too short to tell how long the noise remains correlated."""
    # Fewer than three independent samples tell nothing of correlated noise, and more too little if the
    # autocorrelation at their length is still large.
    short = {
        joint: noise.longest_run
        for (kind, joint), noise in noises.items()
        if not kind.at_rest
        and noise.longest_run is not None
        and (noise.longest_run < 3 or noise.autocorrelation(noise.longest_run) > 0.3)
    }
    if not short:
        return ()
    named = "all joints" if len(short) == len(joint_names) else ", ".join(joint_names[joint] for joint in sorted(short))
    return (
        f"recordings or segments of at most {max(short.values())} independent samples are too short to tell how long "
        f"the torque noise of {named} is correlated: intervals may be too short; use longer ones",
    )


def parameter_scale(r_factors: Sequence[RFactor]) -> FloatArray:
    """Return the size of each parameter that would explain, alone, all torque of a joint it acts on, (P,)."""
    # That is ‖τ‖ / ‖W_i‖ of the joint where it is smallest; zero for one that left no trace.
    norms = np.array([np.linalg.norm(r_factor.R, axis=0) for r_factor in r_factors])
    columns, torques = norms[:, :-1], norms[:, -1:]
    there = (columns > 0.0) & (torques > 0.0)  # a passive joint has no torque to explain
    sizes = np.divide(torques, columns, out=np.full_like(columns, np.inf), where=there).min(axis=0)
    return np.where(np.isfinite(sizes), sizes, 0.0)


def other_scale(sums: FloatArray) -> float:
    """Scale of the torque of rows beside that of a fit, p, from sums of p², p r and r² of each, (3, R); 1 for none."""
    # Residuals r = τ − p, where τ = s p, have s = 1 + Σpr / Σp², which explains (Σpr)² / Σp² of Σr²
    power, product, left = sums
    scales = 1.0 + product / np.maximum(power, TINY)
    odd = (product**2 > MOST * power * left) & (np.abs(np.log(np.maximum(scales, TINY))) > OTHER) & (scales > 0.0)
    return float(np.median(scales[odd])) if np.mean(odd) >= MOST else 1.0


def reference_scale(
    model: RegressorModel, lowest: FloatArray, highest: FloatArray, r_factors: Sequence[RFactor]
) -> FloatArray:
    """Parameter scale of a calm exercise at the recorded angles, (P,)."""
    # A parameter that the recordings hardly excite would have to be huge to explain their torque, and any error
    # of it would look small: a slow motion does not make an inertia sure. Nor does friction that acts for
    # moments only: such a column counts by its largest value, over √3 like one that is spread evenly.
    # Calm is 0.5 Hz and ±18°: up to 1 rad/s and π rad/s².
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1.0, 1.0, (3, 1000, len(lowest)))
    q = 0.5 * (lowest + highest) + 0.5 * (highest - lowest) * q
    columns = np.abs(model.regressor(q, v, np.pi * a)).max(axis=0) / math.sqrt(3.0)
    joints = len(columns)
    squares = np.array([[t.R[:, -1] @ t.R[:, -1], t.rows] for t in r_factors]).reshape(-1, joints, 2).sum(axis=0)
    torques = np.sqrt(squares[:, :1] / np.maximum(squares[:, 1:], 1.0))
    return parameter_scale([RFactor(row[np.newaxis], 1, 1.0) for row in np.hstack([columns, torques])])


def identifiability_class(value: float, std: float, size: float, calm: float = np.inf, index: float = 1.0) -> str:
    """Say how well a parameter is determined: "well", "weakly" or "not"."""
    scale = max(abs(value), SIZE * min(size, calm))
    # A value that alone would give so many times all torque of a joint only cancels another, whatever its error
    if abs(value) > 3.0 * size > 0.0 or std > WEAKLY * scale or index > HOPELESS:
        return "not"
    return "weakly" if std > WELL * scale or index > ILL_CONDITIONED else "well"


def identifiability_beside(name: str, prior_knowledge: PriorKnowledge, std: float, of_data: str) -> str:
    """Say "known" or "prior" of parameters that are rather what was assumed than what was measured."""
    if name in prior_knowledge.known:
        return "known"
    believed = prior_knowledge.prior.values.get(name)
    # A standard deviation beyond this part of the prior's says that the recordings know less than the prior
    return "prior" if believed is not None and std > 0.7 * believed[1] else of_data
