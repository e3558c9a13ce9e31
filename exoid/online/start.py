"""Beginning with what an estimate knows."""

from __future__ import annotations

import numpy as np

from exoid.errors import ExoidError
from exoid.estimate import Estimate

from .settings import Settings
from .state import Information, State

FLOOR = 1e-9
"""Smallest standard deviation of a direction, over the parameter scale."""


def started(settings: Settings, state: State, start: Estimate) -> State:
    """Put an estimate's values and covariance in the place of what was known before the rows.

    Args:
        settings: Settings.
        state: State that knows nothing.
        start: The estimate.

    Returns:
        A state with the values of the estimate.

    Raises:
        ExoidError: The estimator does not weigh rows, so that they cannot stand beside other knowledge.
    """
    if settings.estimator != "wls":
        raise ExoidError("only wls can begin with an estimate", remedy="use estimator='wls', or leave start out")
    scale = np.sqrt(np.diag(start.covariance))
    scale = np.where(scale > 0.0, scale, FLOOR * np.maximum(np.abs(start.values), 1.0))
    sizes, axes = np.linalg.eigh(start.covariance / np.outer(scale, scale))
    root = (axes / np.sqrt(np.maximum(sizes, FLOOR))).T / scale
    R = state.information.R.copy()
    table = np.zeros((settings.count + 1, settings.count + 1))
    table[:-1, :-1], table[:-1, -1] = root, root @ start.values
    R[-1] = np.linalg.qr(table, mode="r")
    rows = np.append(np.zeros(settings.n), start.dof)
    rms = np.maximum(start.residual_rms, 1e-9)
    return state._replace(
        information=Information(R, rows),
        values=start.values.copy(),
        std=scale,
        weights=1.0 / rms,
        checkpoints=np.tile(R, (len(state.checkpoints), 1, 1, 1)),
        checkpoint_rows=np.tile(rows, (len(state.checkpoint_rows), 1)),
    )
