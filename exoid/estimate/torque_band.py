"""How far a predicted torque may be off: the error of the parameters, and the noise of a new measurement."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray


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
