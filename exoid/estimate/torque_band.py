"""How far a predicted torque may be off: the error of the parameters, and the noise of a new measurement."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.model import MotionSamples, RegressorModel
from exoid.torques.motion import BLOCK


class TorqueBand(NamedTuple):
    """Predicted torque and the band around it [N·m], (N, n) each.

    Attributes:
        torque: Prediction.
        lower: Lower edge.
        upper: Upper edge.
    """

    torque: FloatArray
    lower: FloatArray
    upper: FloatArray


def parameter_variance(covariance: FloatArray, rows: FloatArray) -> FloatArray:
    """Variance w C wᵀ that the parameters' errors give a torque."""
    W = rows[..., : len(covariance)]
    return np.asarray(np.clip(((W @ covariance) * W).sum(axis=-1), 0.0, None))


def torque_std(
    model: RegressorModel, variance: Callable[[FloatArray], FloatArray], motion: MotionSamples
) -> FloatArray:
    """Standard deviation of torques of a motion, block by block."""
    std = np.empty((len(motion.q), len(model.row_names)))
    for start in range(0, len(motion.q), BLOCK):
        rows = slice(start, start + BLOCK)
        std[rows] = np.sqrt(variance(model.columns(motion.rows(rows)).transpose(2, 1, 0)))
    return std
