"""How far a predicted torque may be off: the error of the parameters, and the noise of a new measurement."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torques import Motion, TorqueModel

BLOCK = 8192
"""Samples worked on at once."""


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


def torque_std(model: TorqueModel, covariance: FloatArray, motion: Motion) -> FloatArray:
    """Standard deviation √(W C Wᵀ) that the parameters' errors give a torque [N·m], (N, n)."""
    std = np.empty(motion.q.shape)
    for start in range(0, len(motion.q), BLOCK):
        rows = slice(start, start + BLOCK)
        W = model.columns(motion.rows(rows)).transpose(2, 1, 0)
        std[rows] = np.sqrt(np.clip(((W @ covariance) * W).sum(axis=-1), 0.0, None))
    return std
