"""Fit: the solution of a regression, its covariance under the noise of the residuals, and the samples behind it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .jackknife import Jackknife, jackknife
from .least_squares import RFactor, Solution
from .problem import RowProblem, RowSource
from .residuals import Noises, Point, Sandwich, sandwich

TINY = 1e-300
"""Smallest variance to divide by."""

ACCURACY = 5e-4
"""Accuracy of the rows, over the RMS torque of their joint: no interval is narrower than for noise of this size.

Residuals of a simulation without noise are smaller, but they are the errors of filters and differences. These are not
random, and what they do to a parameter is not seen in the residuals.
"""


class Covariance(NamedTuple):
    """Covariance of parameters.

    Attributes:
        matrix: Covariance, (P, P).
        dofs: Degrees of freedom of each variance, (P,); None where they follow from the number of samples.
        stationary: Covariance by models of stationary noise, independent between joints, alone, (P, P).
    """

    matrix: FloatArray
    dofs: FloatArray | None
    stationary: FloatArray


class Fit(NamedTuple):
    """Solution of an estimator, and how rows were weighted.

    Attributes:
        solution: Solution; its covariance is for white noise, unless ``noises`` are given and ``correlated`` is not.
        weights: Weight of the rows of each R factor.
        clip: Limit of weighted residuals, beyond which they count as the limit.
        noises: Noise models of the rows, which the covariance is for; None to estimate them from the residuals.
        warnings: Warnings for the reader.
        whitened: Whether rows were whitened by these models.
        correlated: Covariance for correlated noise where the rows of the problem are not those that were fitted; the
            one of the solution is for white noise.
        name: Name of the estimator with the settings that it chose; "" for its own name.
    """

    solution: Solution
    weights: Sequence[float]
    clip: float = np.inf
    noises: Noises | None = None
    warnings: tuple[str, ...] = ()
    whitened: bool = False
    correlated: Covariance | None = None
    name: str = ""

    @property
    def point(self) -> Point:
        """Parameters and weights at which residuals are computed."""
        return Point(self.solution.values, self.weights, self.clip)


class Uncertainty(NamedTuple):
    """Covariance of a fit, and the noise that it is for.

    Attributes:
        found: The covariance.
        noises: Noise of each kind and joint.
        white: Whether the covariance assumes white noise.
    """

    found: Covariance
    noises: Noises
    white: bool

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the parameters, (P, P)."""
        return self.found.matrix

    @property
    def dofs(self) -> FloatArray | None:
        """Degrees of freedom of each variance, (P,); None where they follow from the number of samples."""
        return self.found.dofs


def uncertainty_of(problem: RowProblem, fit: Fit, *, white: bool) -> Uncertainty:
    """Find the noise in the residuals of a fit and the covariance under it.

    Args:
        problem: The problem.
        fit: Its solution; an estimator that brings its own noise keeps it.
        white: Whether to take the textbook's covariance for white noise instead.

    Returns:
        The covariance with its noise.

    Raises:
        ExoidError: White noise is requested of an estimator that uses a model of correlated noise.
    """
    solution = fit.solution
    textbook = Covariance(solution.covariance, None, solution.covariance)
    if fit.noises is None:
        bare = sandwich(problem, fit.point, solution)
        found = textbook if white else _correlated(problem, fit.point, solution, bare)
        return Uncertainty(_not_below(found, smallest_variances(problem, fit)), bare.noises, white)
    if fit.correlated is not None:
        return Uncertainty(textbook if white else fit.correlated, fit.noises, white)
    if white:
        raise ExoidError(
            "this estimator weighs rows by a model of correlated noise, so that noise='white' does not apply",
            remedy="leave noise out, or use wls",
        )
    if not fit.whitened:
        return Uncertainty(textbook, fit.noises, white)
    left_out = jackknife(problem, fit.point, fit.noises, solution, whitened=True)
    return Uncertainty(_rescaled(solution.covariance, left_out), fit.noises, white)


def correlated_covariance(rows: RowSource, point: Point, solution: Solution) -> Covariance:
    """Covariance of a least-squares estimate for correlated noise that need not be stationary, nor independent.

    Args:
        rows: Its rows.
        point: Parameters and weights.
        solution: (WᵀW)⁻¹ of the weighted rows, and a first idea of the covariance.

    Returns:
        The covariance.
    """
    return _correlated(rows, point, solution, sandwich(rows, point, solution))


def _correlated(rows: RowSource, point: Point, solution: Solution, bare: Sandwich) -> Covariance:
    """Variances by the jackknife, correlations by the noise models."""
    return _rescaled(bare.covariance, jackknife(rows, point, bare.noises, solution, whitened=False))


def _rescaled(covariance: FloatArray, found: Jackknife) -> Covariance:
    """S C S with S_i² = V_i / C_ii; there is nothing to rescale where fewer than two blocks are left out."""
    if not found.blocks:
        return Covariance(covariance, None, covariance)
    variances = np.diag(covariance)
    scale = np.sqrt(np.divide(found.variances, variances, out=np.ones(len(variances)), where=variances > TINY))
    return Covariance(covariance * np.multiply.outer(scale, scale), found.dofs, covariance)


def smallest_variances(problem: RowProblem, fit: Fit) -> FloatArray:
    """Compute the variances for white noise of :data:`ACCURACY` of the RMS torque of each joint.

    Args:
        problem: The problem.
        fit: Its solution.

    Returns:
        Variance of each parameter, zero for known ones, (P,).
    """
    inverse = fit.solution.inverse
    variances = np.zeros(len(inverse))
    for r_factor, weight in zip(problem.r_factors, fit.weights, strict=True):
        if r_factor.rows:
            size = ACCURACY**2 * float(r_factor.R[:, -1] @ r_factor.R[:, -1]) / r_factor.samples
            variances += weight**4 * size * ((r_factor.R[:, :-1] @ inverse) ** 2).sum(axis=0)
    return variances


def _not_below(found: Covariance, smallest: FloatArray) -> Covariance:
    """Raise the variances that are smaller; correlations stay."""
    variances = np.diag(found.matrix)
    if (variances >= smallest).all():
        return found
    scale = np.sqrt(np.maximum(1.0, smallest / np.maximum(variances, TINY)))
    return found._replace(matrix=found.matrix * np.multiply.outer(scale, scale))


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
