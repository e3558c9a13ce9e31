"""Parameters whose uncertainty limits a margin."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from exoid._typing import FloatArray

TAIL = 0.1
"""Share of the worst draws whose mean is the point of the gradient."""

STEP = 0.01
"""Step of the gradient in standard deviations."""


def variance_shares(
    margin: Callable[[FloatArray], FloatArray], point: FloatArray, covariance: FloatArray
) -> FloatArray:
    """Compute by which share the variance of a margin would fall if one parameter were known exactly.

    For the linearised margin with gradient g, this is r_i² = (Σ g)_i² / (Σ_ii gᵀ Σ g), the squared correlation of
    parameter and margin. Correlated parameters share what they explain, so the sum may exceed 1.

    Args:
        margin: Function of sets of parameters, (B, P), that returns (B,).
        point: Parameters at which the gradient is taken, (P,).
        covariance: Covariance Σ of the parameters, (P, P).

    Returns:
        Shares, (P,); zero for parameters without variance.
    """
    std = np.sqrt(np.diag(covariance))
    step = STEP * np.where(std > 0.0, std, 1.0)
    ahead, behind = (margin(point + sign * np.diag(step)) for sign in (1.0, -1.0))
    gradient = np.where(std > 0.0, (ahead - behind) / (2.0 * step), 0.0)
    along = covariance @ gradient
    variance = float(gradient @ along)
    if variance <= 0.0:
        return np.zeros(len(std))
    return np.asarray(np.where(std > 0.0, along / np.where(std > 0.0, std, 1.0), 0.0) ** 2 / variance)
