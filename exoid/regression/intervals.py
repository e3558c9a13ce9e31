"""Confidence intervals by Student's t."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError


def half_width(level: float, dof: FloatArray | float) -> FloatArray:
    """Half width of an interval in standard deviations, for each number of degrees of freedom."""
    if not 0.0 < level < 1.0:
        raise BadArgumentError(f"an interval of level {level}", remedy="use a level between 0 and 1, such as 0.95")
    return np.asarray(scipy.stats.t.ppf(0.5 + level / 2.0, dof))


def intervals(values: FloatArray, std: FloatArray, dof: FloatArray, level: float) -> FloatArray:
    """Confidence intervals, (P, 2)."""
    half = half_width(level, dof) * std
    return np.column_stack([values - half, values + half])
