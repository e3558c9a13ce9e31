"""How well an estimate predicts the torque of a recording it was not fitted to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.rows import form_rows, prepare
from exoid.signals import Preparation, Recording
from exoid.tables import make_table, to_text

from .data import EstimateData


@dataclass(frozen=True, eq=False, repr=False)
class Validation:
    """Measured and predicted torque, filtered alike, and what lies between them.

    Attributes:
        joint_names: Joints, (n,).
        time: [s], (N,).
        measured: Filtered measured torque [N·m], (N, n).
        predicted: Filtered predicted torque [N·m], (N, n).
        source: Name of the recording.
    """

    joint_names: tuple[str, ...]
    time: FloatArray
    measured: FloatArray
    predicted: FloatArray
    source: str

    def __post_init__(self) -> None:
        """Forbid changes."""
        for array in (self.time, self.measured, self.predicted):
            array.flags.writeable = False

    @property
    def residual(self) -> FloatArray:
        """Measured less predicted torque [N·m], (N, n)."""
        return self.measured - self.predicted

    @property
    def rmse(self) -> FloatArray:
        """Root of the mean squared residual [N·m], (n,)."""
        return np.asarray(np.sqrt(np.mean(self.residual**2, axis=0)))

    @property
    def nrmse(self) -> FloatArray:
        """RMSE over the standard deviation of the measured torque, (n,); not a number where that is constant."""
        spread = self.measured.std(axis=0)
        return np.asarray(np.divide(self.rmse, spread, out=np.full(len(spread), np.nan), where=spread > 0.0))

    @property
    def r2(self) -> FloatArray:
        """Coefficient of determination 1 − Σ residual² / Σ (measured − mean)², (n,)."""
        return 1.0 - self.nrmse**2

    def __repr__(self) -> str:
        """Name the joints and their NRMSE."""
        errors = ", ".join(f"{n} {e:.3f}" for n, e in zip(self.joint_names, self.nrmse, strict=True))
        return f"Validation(nrmse: {errors})"

    def __str__(self) -> str:
        """Print as a table."""
        rows = [
            (name, f"{rmse:.4g}", f"{nrmse:.4f}", f"{r2:.4f}")
            for name, rmse, nrmse, r2 in zip(self.joint_names, self.rmse, self.nrmse, self.r2, strict=True)
        ]
        table = make_table(("joint", "RMSE [N·m]", "NRMSE", "R²"), rows)
        return to_text(f"Prediction of {self.source}", table, f"{len(self.time)} samples, both torques filtered alike")


def validation_to_json(validation: Validation) -> dict[str, Any]:
    """Turn the figures of a validation into what JSON can hold."""
    return {
        "source": validation.source,
        "samples": len(validation.time),
        "joint_names": list(validation.joint_names),
        "rmse": validation.rmse.tolist(),
        "nrmse": _numbers(validation.nrmse),
        "r2": _numbers(validation.r2),
    }


def _numbers(array: FloatArray) -> list[float | None]:
    """List numbers; JSON knows no NaN, so that becomes null."""
    return [value if np.isfinite(value) else None for value in array.tolist()]


def validate(estimate: EstimateData, recording: Recording, *, preparation: Preparation | None = None) -> Validation:
    """Predict the torque of a recording and compare.

    Args:
        estimate: The estimate.
        recording: A motion with torques, better not one that the estimate was fitted to.
        preparation: How to filter both torques; None for the way the estimate was made.

    Returns:
        Measured and predicted torque with RMSE, NRMSE and R² of each joint.

    Raises:
        ExoidError: The recording lacks a joint or the torque, or is too short for the filter.
    """
    prepared = prepare(estimate.model, recording, preparation or estimate.preparation, every=True)
    rows = (form_rows(estimate.model, prepared, stretch) for stretch in prepared.stretches())
    parts = [(of_some.time, of_some.tau, of_some.W @ estimate.values) for of_some in rows]
    time, measured, predicted = (np.concatenate(part) for part in zip(*parts, strict=True))
    source = recording.source.name if recording.source else "array"
    return Validation(estimate.joint_names, time, measured, predicted, source)
