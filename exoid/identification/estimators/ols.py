"""Ordinary least squares."""

from __future__ import annotations

from exoid.regression.problem import Reduced
from exoid.regression.r_factor import join

from .fit import Fit


def ols(problem: Reduced) -> Fit:
    """Every torque row counts the same, whichever joint it comes from: min Σ ‖W β − τ‖²."""
    return Fit(problem.solve(join(problem.triangles)), [1.0] * len(problem.triangles))
