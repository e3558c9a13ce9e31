"""Weighted least squares."""

from __future__ import annotations

import math

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.problem import Reduced
from exoid.regression.r_factor import Triangle, join

from .fit import Fit
from .ols import ols

NOISELESS = 1e-9
"""Residuals below this fraction of the leg's torque are rounding, not noise, and do not raise a weight further."""


def wls(problem: Reduced) -> Fit:
    """Each joint's rows are divided by that joint's own residual of a first, ordinary, fit.

    A hip whose sensor errs by 1 N·m then no longer drowns an ankle whose sensor errs by 0.1 N·m.
    """
    first = ols(problem).solution.values
    floor = noise_floor(problem)
    weights = [1.0 / max(_rms(triangle, first), floor) for triangle in problem.triangles]
    return Fit(problem.solve(join(problem.triangles, weights)), weights)


def noise_floor(problem: Reduced) -> float:
    """Size below which a residual is rounding [N·m]."""
    torque = max(float(np.linalg.norm(t.R[:, -1])) / math.sqrt(max(t.rows, 1)) for t in problem.triangles)
    return NOISELESS * torque


def _rms(triangle: Triangle, values: FloatArray) -> float:
    """RMS residual of one joint [N·m]."""
    return triangle.residual(values) / math.sqrt(max(triangle.rows, 1))
