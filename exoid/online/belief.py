"""What a recursive estimator knows, as one R factor with noise of unit size, for those who combine it with a prior."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .correlation import inflations
from .settings import Settings
from .solution import weighted_stack
from .state import State


def belief(settings: Settings, state: State) -> FloatArray:
    """Combine the R factors of all joints, weighted, with rows counted by their autocorrelation.

    Args:
        settings: Settings.
        state: State of the estimator.

    Returns:
        [R z] with R β = z + noise of unit size, (P + 1, P + 1); zero before the first rows.
    """
    inflation = inflations(settings, state.correlation)
    stacked = weighted_stack(state.information, state.weights, inflation)
    return np.asarray(stacked / np.sqrt(inflation.mean()))
