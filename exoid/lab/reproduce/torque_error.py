"""Torque error of a model on a validation motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.every_row import make_rows
from exoid.regression.row_data import Rows
from exoid.signals import Recording, ZeroPhase
from exoid.torques import TorqueModel


def validation_rows(model: TorqueModel, recording: Recording) -> Rows:
    """Make the rows of a validation motion: regressor and measured torque behind the same filter."""
    return make_rows(model, recording, ZeroPhase(cutoff=5.0))  # filter of measured and predicted torque


def predicted_torque(model: TorqueModel, values: Mapping[str, float], rows: Rows) -> FloatArray:
    """Predict the torque of rows [N·m], (N, n), from parameters by name; the others are zero."""
    return np.asarray(rows.W @ np.array([values.get(name, 0.0) for name in model.names]))


def torque_nrmse(model: TorqueModel, values: Mapping[str, float], recording: Recording) -> FloatArray:
    """Compute the RMS torque error of parameters by name over the standard deviation of the measured torque, (n,)."""
    rows = validation_rows(model, recording)
    error = rows.tau - predicted_torque(model, values, rows)
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)) / rows.tau.std(axis=0))


def joint_errors(errors: FloatArray) -> str:
    """Write the NRMSE of the joints, one behind the other."""
    return " / ".join(f"{error:.3f}" for error in errors)
