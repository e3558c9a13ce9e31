"""Fit: the solution of a regression, its covariance under the noise of the residuals, and the samples behind it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .degrees_of_freedom import degrees_of_freedom
from .least_squares import Solution
from .problem import RowProblem
from .r_factor import RFactor
from .residuals import Noises, Point, sandwich


class Fit(NamedTuple):
    """A solution and how it was come by.

    Attributes:
        solution: Its covariance is for white noise, unless ``noises`` are given.
        weights: Of the rows of each R factor.
        clip: Weighted residuals beyond this counted as this.
        noises: The noise that the covariance is for; None if it still has to be found.
        warnings: What the reader should know.
        dofs: Degrees of freedom of each parameter's variance, (P,); None if they still have to be found.
        name: Of the estimator with the settings that it chose; "" for its own name.
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
        """Where residuals are to be looked at."""
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
