"""How many independent samples stand behind parameters that several groups know of, and how well posed they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.identification.estimators import Fit
from exoid.regression.degrees_of_freedom import degrees_of_freedom
from exoid.regression.least_squares import Solution
from exoid.regression.problem import Stacked
from exoid.regression.residuals import Noises, sandwich

from .problem import JointProblem


class OfNoise(NamedTuple):
    """What noise makes of a fit.

    Attributes:
        covariance: Of the parameters, (P, P).
        noises: Noise of each kind and joint.
        dofs: Degrees of freedom of each parameter's variance by what is known of the noise, (P,); None if it is white.
    """

    covariance: FloatArray
    noises: Noises
    dofs: FloatArray | None


def noise_of(problem: Stacked, fit: Fit, *, white: bool) -> OfNoise:
    """Find the noise in the residuals of a fit and the covariance under it, or that of the textbook for white noise."""
    noises, dofs, solution = fit.noises, fit.dofs, fit.solution
    if noises is None:
        covariance, noises = sandwich(problem, fit.point, solution)
        solution = solution._replace(covariance=covariance)
        dofs = None if white else degrees_of_freedom(problem, fit.point, noises, solution, whitened=False)
    return OfNoise(fit.solution.covariance, noises, None) if white else OfNoise(solution.covariance, noises, dofs)


class Left(NamedTuple):
    """Independent samples less parameters.

    Attributes:
        groups: Of the rows of each group.
        each: Of each parameter, (P,).
    """

    groups: FloatArray
    each: FloatArray


def samples_left(problem: JointProblem, solution: Solution, weights: Sequence[float], samples: Sequence[float]) -> Left:
    """Count the samples that stand behind each group, and each parameter.

    The rows W_g of group g, whose N_g samples are independent, are fitted by p_g = tr(A⁻¹ W_gᵀ W_g) parameters, with
    A = Σ_g W_gᵀ W_g: these add up to P, and leave ν_g = N_g − p_g. The variance of a parameter is the sum of what each
    group brings in, v_g = (A⁻¹ W_gᵀ W_g A⁻¹)_ii, and has (Σ v_g)² / Σ (v_g² / ν_g) (Welch and Satterthwaite).

    Args:
        problem: The problem.
        solution: For A⁻¹.
        weights: Of the triangles.
        samples: Independent samples N_g of each group.
    """
    inverse = solution.inverse
    rows = [problem.rows_of(group, weights).R[:, : len(inverse)] for group in range(len(samples))]
    roots = [R @ inverse for R in rows]
    fitted = np.array([np.einsum("ij,ij->", R, root) for R, root in zip(rows, roots, strict=True)])
    fitted *= problem.assumed.free(problem.names).sum() / fitted.sum()
    left = np.maximum(1.0, np.array(samples) - fitted)
    brought = np.array([(root**2).sum(axis=0) for root in roots])
    total, spread = brought.sum(axis=0), (brought**2 / left[:, None]).sum(axis=0)
    return Left(left, np.divide(total**2, spread, out=np.full(len(total), left.min()), where=spread > 0.0))


def condition_number(inverse: FloatArray, places: NDArray[np.intp]) -> float:
    """Condition number of some parameters' scaled regressor, the columns of all others projected out.

    Args:
        inverse: (WᵀW)⁻¹ of all parameters, zero for known ones, (P, P).
        places: Of the parameters.
    """
    free = places[np.diag(inverse)[places] > 0.0]
    information = np.linalg.inv(_scaled(inverse[np.ix_(free, free)]))
    sizes = np.linalg.eigvalsh(_scaled(np.asarray(information, dtype=np.float64)))
    return float(np.sqrt(sizes[-1] / max(sizes[0], np.finfo(float).eps)))


def _scaled(matrix: FloatArray) -> FloatArray:
    """Scale rows and columns so that the diagonal is 1."""
    scale = np.sqrt(np.diag(matrix))
    return np.asarray(matrix / np.multiply.outer(scale, scale))
