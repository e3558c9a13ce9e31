"""Fit: the solution of a regression, its covariance under the noise of the residuals, and the samples behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .least_squares import RFactor, Solution
from .noise import AutoregressiveNoise
from .problem import RowProblem
from .residuals import Noises, Point, Series, over_recordings, sandwich
from .rows import NoiseKind

TINY = 1e-300
"""Smallest variance to divide by."""


class Fit(NamedTuple):
    """Solution of an estimator, and how rows were weighted.

    Attributes:
        solution: Solution; its covariance is for white noise, unless ``noises`` are given.
        weights: Weight of the rows of each R factor.
        clip: Limit of weighted residuals, beyond which they count as the limit.
        noises: Noise models that the covariance is for; None to estimate them from the residuals.
        warnings: Warnings for the reader.
        dofs: Degrees of freedom of each parameter's variance, (P,); None to compute them.
        name: Name of the estimator with the settings that it chose; "" for its own name.
    """

    solution: Solution
    weights: Sequence[float]
    clip: float = np.inf
    noises: Noises | None = None
    warnings: tuple[str, ...] = ()
    dofs: FloatArray | None = None
    name: str = ""

    @property
    def point(self) -> Point:
        """Parameters and weights at which residuals are computed."""
        return Point(self.solution.values, self.weights, self.clip)


class Uncertainty(NamedTuple):
    """Covariance of a fit, and the noise that it is for.

    Attributes:
        covariance: Covariance of the parameters, (P, P).
        noises: Noise of each kind and joint.
        dofs: Degrees of freedom of each parameter's variance by what is known of the noise, (P,); None where they
            follow from the number of samples.
        white: Whether the covariance assumes white noise.
    """

    covariance: FloatArray
    noises: Noises
    dofs: FloatArray | None
    white: bool


def uncertainty_of(problem: RowProblem, fit: Fit, *, white: bool) -> Uncertainty:
    """Find the noise in the residuals of a fit and the covariance under it.

    Args:
        problem: The problem.
        fit: Its solution; an estimator that brings its own noise keeps it.
        white: Whether to take the textbook's covariance for white noise instead.

    Returns:
        The covariance with its noise.
    """
    noises, dofs, solution = fit.noises, fit.dofs, fit.solution
    if noises is None:
        covariance, noises = sandwich(problem, fit.point, solution)
        solution = solution._replace(covariance=covariance)
        dofs = None if white else degrees_of_freedom(problem, fit.point, noises, solution, whitened=False)
    if white:
        return Uncertainty(fit.solution.covariance, noises, None, white)
    return Uncertainty(solution.covariance, noises, dofs, white)


class SamplesLeft(NamedTuple):
    """Independent samples less parameters.

    Attributes:
        groups: Those of the rows of each group, (G,).
        each: Those of each parameter, (P,).
    """

    groups: FloatArray
    each: FloatArray


def samples_left(rows: Sequence[RFactor], inverse: FloatArray, samples: Sequence[float], free: int) -> SamplesLeft:
    """Count the samples that stand behind each group, and each parameter.

    The rows W_g of group g, whose N_g samples are independent, are fitted by p_g = tr(A⁻¹ W_gᵀ W_g) parameters, with
    A = Σ_g W_gᵀ W_g: these add up to P, and leave ν_g = N_g − p_g. The variance of a parameter is the sum of what each
    group brings in, v_g = (A⁻¹ W_gᵀ W_g A⁻¹)_ii, and has (Σ v_g)² / Σ (v_g² / ν_g) (Welch and Satterthwaite).

    Args:
        rows: R factor of the weighted rows of each group.
        inverse: A⁻¹, zero for known parameters, (P, P).
        samples: Independent samples N_g of each group.
        free: Number of parameters that are not known.

    Returns:
        Samples left for each group and parameter, at least 1.
    """
    if len(rows) == 1:
        left = max(1.0, samples[0] - free)
        return SamplesLeft(np.array([left]), np.full(len(inverse), left))
    factors = [of_group.R[:, : len(inverse)] for of_group in rows]
    roots = [R @ inverse for R in factors]
    fitted = np.array([np.einsum("ij,ij->", R, root) for R, root in zip(factors, roots, strict=True)])
    fitted *= free / fitted.sum()
    of_groups = np.maximum(1.0, np.array(samples) - fitted)
    brought = np.array([(root**2).sum(axis=0) for root in roots])
    total, spread = brought.sum(axis=0), (brought**2 / of_groups[:, None]).sum(axis=0)
    each = np.divide(total**2, spread, out=np.full(len(total), of_groups.min()), where=spread > 0.0)
    return SamplesLeft(of_groups, each)


def condition_number(inverse: FloatArray, places: NDArray[np.intp]) -> float:
    """Condition number of some parameters' scaled regressor, the columns of all others projected out.

    Args:
        inverse: (WᵀW)⁻¹ of all parameters, zero for known ones, (P, P).
        places: Indices of the parameters.

    Returns:
        The condition number, at least 1.
    """
    free = places[np.diag(inverse)[places] > 0.0]
    information = np.linalg.inv(_scaled(inverse[np.ix_(free, free)]))
    sizes = np.linalg.eigvalsh(_scaled(np.asarray(information, dtype=np.float64)))
    return float(np.sqrt(sizes[-1] / max(sizes[0], np.finfo(float).eps)))


def _scaled(matrix: FloatArray) -> FloatArray:
    """Scale rows and columns so that the diagonal is 1."""
    scale = np.sqrt(np.diag(matrix))
    return np.asarray(matrix / np.multiply.outer(scale, scale))


def degrees_of_freedom(
    problem: RowProblem, point: Point, noises: Noises, solution: Solution, *, whitened: bool
) -> FloatArray:
    """Satterthwaite's ν_i = 2 V_i² / var V_i of each parameter's variance V_i, (P,); infinite where V_i is exact.

    The variance of a parameter depends on the noise at the frequencies of the motion, of which a recording contains few
    periods: ν is well below the number of samples. With the autoregressive noise of kind and joint known to
    var ln σ² = 2 / N, cov φ = σ² Γ_p⁻¹ / N (Brockwell and Davis, ch. 8), var V_i is that of first order in both. Of N
    samples a share P / Σ N went into the parameters; for white noise of one joint ν = N − P, as in textbooks.
    Uncertainty in the selected order is ignored.

    Args:
        problem: The problem.
        point: Parameters and weights of its solution.
        noises: The noise that the covariance is for.
        solution: Covariance V, and (WᵀW)⁻¹ of the weighted rows.
        whitened: Whether V = (W Γ⁻¹ Wᵀ)⁻¹, not the sandwich.

    Returns:
        Degrees of freedom of each parameter, (P,).
    """
    rows = solution.covariance if whitened else solution.inverse
    slopes: dict[tuple[NoiseKind, int], FloatArray] = {}
    for of_recording in over_recordings(problem, point, partial(_slopes, noises, rows, whitened)):
        for key, slope in of_recording.items():
            slopes[key] = slopes.get(key, 0.0) + slope
    samples = sum(noises[key].samples for key in slopes)
    left = max(1.0 - float(np.count_nonzero(np.diag(rows))) / max(samples, 1.0), TINY)
    spread = sum(_spread(noises[key], slope) for key, slope in slopes.items()) / left
    variance = np.diag(solution.covariance)
    return np.asarray(np.divide(2.0 * variance**2, spread, out=np.full(len(variance), np.inf), where=spread > TINY))


def _slopes(
    noises: Noises, rows: FloatArray, whitened: bool, parts: Iterator[Series]
) -> dict[tuple[NoiseKind, int], FloatArray]:
    """Slopes of what one recording adds to V_i, by kind and joint."""
    slopes: dict[tuple[NoiseKind, int], FloatArray] = {}
    running: dict[int, _Slope] = {}
    for part in parts:
        key = (part.kind, part.joint)
        if part.begins:
            running[part.joint] = _Slope(noises[key], len(rows), whitened)
        running[part.joint].add(rows[:, part.columns] @ part.X, part.usable)
        if part.ends:
            slopes[key] = (1.0 if whitened else part.stands_for**2) * running[part.joint].total()
    return slopes


def _spread(noise: AutoregressiveNoise, slope: FloatArray) -> FloatArray:
    """Variance of V_i that the noise of one kind and joint leaves, given dV_i / d(ln σ², φ), (P,)."""
    of_predictors = noise.variances[-1] * (noise.whiten(slope[:, 1:]) ** 2).sum(axis=1) if noise.order else 0.0
    return np.asarray((2.0 * slope[:, 0] ** 2 + of_predictors) / max(noise.samples, 1.0))


class _Slope:
    """dV_i / d(ln σ², φ_1 … φ_p) of what one joint adds to V_i, from rows b_i that come stretch by stretch.

    In the sandwich V_i = σ² Σ y², with y = b / φ(L) and ∂y/∂φ_k = L^k y / φ(L). Whitened, b = V X, V_i is
    Σ u² / σ² with u = φ(L) b and ∂u/∂φ_k = −L^k b, but as it is information that changes, not variance, the sign
    turns.
    """

    def __init__(self, noise: AutoregressiveNoise, rows: int, whitened: bool) -> None:
        self.noise, self.whitened = noise, whitened
        p = noise.order
        self._states = np.zeros((2, rows, p))
        self._past = np.zeros((rows, p))
        self._sums = np.zeros((rows, p + 1))
        self._samples = 0

    def add(self, rows: FloatArray, usable: FloatArray | float) -> None:
        """Go on with the next samples, zero at those left out, (P, N)."""
        p, polynomial = self.noise.order, self.noise.polynomial
        head = tail = rows
        if p and self.whitened:
            head, self._states[0] = scipy.signal.lfilter(polynomial, [1.0], rows, zi=self._states[0])
            head = head * usable
        elif p:
            head, self._states[0] = scipy.signal.lfilter([1.0], polynomial, rows, zi=self._states[0])
            tail, self._states[1] = scipy.signal.lfilter([1.0], polynomial, head, zi=self._states[1])
        past, count = np.hstack([self._past, tail]), rows.shape[1]
        self._sums[:, 0] += np.einsum("it,it->i", head, head)
        for k in range(1, p + 1):
            self._sums[:, k] += 2.0 * np.einsum("it,it->i", head, past[:, p - k : p - k + count])
        self._past = past[:, past.shape[1] - p :].copy()
        self._samples += count

    def total(self) -> FloatArray:
        """The slopes of all that was added, (P, p + 1)."""
        if not self.whitened:
            self.add(np.zeros((len(self._sums), self.noise.ring(self._samples))), 1.0)
        size = self.noise.variances[-1]
        return np.asarray(self._sums * (1.0 / max(size, TINY) if self.whitened else size))
