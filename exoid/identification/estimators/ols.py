"""Ordinary least squares."""

from __future__ import annotations

from exoid.regression.fit import Fit
from exoid.regression.problem import LeastSquaresProblem
from exoid.regression.r_factor import stack


def ols(problem: LeastSquaresProblem) -> Fit:
    """Every torque row counts the same, whichever joint it comes from: min Σ ‖W β − τ‖²."""
    return Fit(problem.solve(stack(problem.r_factors)), [1.0] * len(problem.r_factors))
