"""Causal exponential moving average of doc. 2."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError


def exponential_moving_average(x: FloatArray, alpha: float) -> FloatArray:
    """Smooth columns as in doc. 2, sec. III: y_k = α x_k + (1 − α) y_{k−1}, from y_0 = x_0."""
    # The filter is causal: it delays a ramp by (1 − α)/α samples.
    if not 0.0 < alpha <= 1.0:
        raise BadArgumentError(f"alpha is {alpha}", remedy="pass 0 < alpha ≤ 1, the weight of the newest sample")
    smoothed, _ = scipy.signal.lfilter([alpha], [1.0, alpha - 1.0], x, axis=0, zi=(1.0 - alpha) * x[:1])
    return np.asarray(smoothed, dtype=np.float64)
