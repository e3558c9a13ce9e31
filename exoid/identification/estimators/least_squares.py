"""Ordinary least squares, and least squares weighted joint by joint."""

from __future__ import annotations

import math

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.fit import Fit
from exoid.regression.least_squares import RFactor, stack
from exoid.regression.problem import LeastSquaresProblem

NOISELESS = 1e-9
"""Residuals below this fraction of the leg's torque are rounding, not noise, and do not raise a weight further."""


def ols(problem: LeastSquaresProblem) -> Fit:
    """Weigh every torque row alike, whichever joint it comes from: min Σ ‖W β − τ‖² (doc. 1, eq. (17)).

    Args:
        problem: The problem.

    Returns:
        The fit.
    """
    return Fit(problem.solve(stack(problem.r_factors)), [1.0] * len(problem.r_factors))


def wls(problem: LeastSquaresProblem) -> Fit:
    """Each joint's rows are divided by that joint's own residual of a first, ordinary, fit.

    A hip whose sensor errs by 1 N·m then no longer drowns an ankle whose sensor errs by 0.1 N·m.

    Args:
        problem: The problem.

    Returns:
        The fit.
    """
    first = ols(problem).solution.values
    floor = noise_floor(problem)
    weights = [1.0 / max(_rms(r_factor, first), floor) for r_factor in problem.r_factors]
    return Fit(problem.solve(stack(problem.r_factors, weights)), weights)


def noise_floor(problem: LeastSquaresProblem) -> float:
    """Size below which a residual is rounding [N·m]."""
    torque = max(float(np.linalg.norm(t.R[:, -1])) / math.sqrt(max(t.rows, 1)) for t in problem.r_factors)
    return NOISELESS * torque


def _rms(r_factor: RFactor, values: FloatArray) -> float:
    """RMS residual of one joint [N·m]."""
    return r_factor.residual(values) / math.sqrt(max(r_factor.rows, 1))
