"""How far a model's torque is from the measured one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.regression.rows import Rows, make_rows
from exoid.signals import Recording, ZeroPhase
from exoid.torques import TorqueModel

VALIDATION_FILTER = ZeroPhase(cutoff=5.0)
"""Of measured and predicted torque alike."""


def by_name(estimate: Estimate) -> dict[str, float]:
    """Values of an estimate by name."""
    return dict(zip(estimate.names, estimate.values.tolist(), strict=True))


def validation_rows(model: TorqueModel, recording: Recording) -> Rows:
    """Regressor and measured torque of a validation motion, filtered alike."""
    return make_rows(model, recording, VALIDATION_FILTER)


def predicted_torque(model: TorqueModel, values: Mapping[str, float], rows: Rows) -> FloatArray:
    """Torque of parameters by name [N·m], (N, n); what is not named is zero."""
    return np.asarray(rows.W @ np.array([values.get(name, 0.0) for name in model.names]))


def torque_rmse(model: TorqueModel, values: Mapping[str, float], recording: Recording) -> FloatArray:
    """RMS torque error of parameters by name [N·m], (n,)."""
    rows = validation_rows(model, recording)
    return np.asarray(np.sqrt(np.mean((rows.tau - predicted_torque(model, values, rows)) ** 2, axis=0)))


def torque_nrmse(model: TorqueModel, values: Mapping[str, float], recording: Recording) -> FloatArray:
    """RMS torque error over the standard deviation of the measured torque, (n,)."""
    return np.asarray(torque_rmse(model, values, recording) / validation_rows(model, recording).tau.std(axis=0))
