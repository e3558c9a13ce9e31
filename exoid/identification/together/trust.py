"""How many independent samples stand behind parameters that several groups know of, and how well posed they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.identification.least_squares import Solution

from .problem import JointProblem


def degrees_of_freedom(
    problem: JointProblem, solution: Solution, weights: Sequence[float], samples: Sequence[float]
) -> FloatArray:
    """Degrees of freedom of each parameter, (P,).

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
    roots = [problem.rows_of(group, weights).R[:, : len(inverse)] @ inverse for group in range(len(samples))]
    brought = np.array([(root**2).sum(axis=0) for root in roots])
    fitted = np.array([np.trace(problem.rows_of(g, weights).R[:, : len(inverse)].T @ x) for g, x in enumerate(roots)])
    fitted *= problem.assumed.free(problem.names).sum() / fitted.sum()
    left = np.maximum(1.0, np.array(samples) - fitted)
    total = brought.sum(axis=0)
    dof = np.where(total > 0.0, total, 1.0) ** 2 / np.where(total > 0.0, (brought**2 / left[:, None]).sum(axis=0), 1.0)
    return np.asarray(np.where(total > 0.0, dof, left.min()))


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
