"""Estimators by name: from one triangle a joint to parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray

from .least_squares import Solution, solve
from .rows import Triangle, join

Estimator = Callable[[Sequence[Triangle], Sequence[str]], Solution]
"""Takes the triangle of each joint and the parameter names."""

NOISELESS = 1e-9
"""Residuals below this fraction of the leg's torque are rounding, not noise, and do not raise a weight further."""


def ols(triangles: Sequence[Triangle], names: Sequence[str]) -> Solution:
    """Ordinary least squares: every torque row counts the same, whichever joint it comes from."""
    return solve(join(triangles), names)


def wls(triangles: Sequence[Triangle], names: Sequence[str]) -> Solution:
    """Weighted least squares: each joint's rows are divided by that joint's own residual of a first, ordinary, fit.

    A hip whose sensor errs by 1 N·m then no longer drowns an ankle whose sensor errs by 0.1 N·m.
    """
    first = ols(triangles, names).values
    torque = max(float(np.linalg.norm(triangle.R[:, -1])) for triangle in triangles)
    return solve(join(triangles, [1.0 / _noise(triangle, first, torque) for triangle in triangles]), names)


def _noise(triangle: Triangle, values: FloatArray, torque: float) -> float:
    """RMS residual of one joint [N·m], kept away from zero."""
    return max(triangle.residual(values), NOISELESS * torque) / math.sqrt(max(triangle.rows, 1))


ESTIMATORS: Mapping[str, Estimator] = {"ols": ols, "wls": wls}
