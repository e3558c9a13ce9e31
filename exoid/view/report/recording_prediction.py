"""A recording and the torque that an estimate predicts for it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate, Validation, validate
from exoid.regression.rows import for_leg
from exoid.signals import Recording
from exoid.signals.moving_base import base_during


class RecordingPrediction(NamedTuple):
    """A recording, its motion, and its predicted torque with a prediction band and the part that is friction."""

    recording: Recording  # recording at even time stamps
    q: FloatArray  # angles [rad], (N, n)
    v: FloatArray  # velocities [rad/s], (N, n)
    validation: Validation  # measured and predicted torque
    friction: FloatArray  # friction terms of the predicted torque [N·m], (N, n)

    @property
    def band_half_width(self) -> FloatArray:
        """Half the width of the prediction band [N·m], (N, n)."""
        return self.validation.half_width

    @property
    def coverage(self) -> FloatArray:
        """Share of the measured torques within the band, (n,)."""
        return self.validation.coverage

    @property
    def measured_friction(self) -> FloatArray:
        """Measured torque less all predicted torque except friction [N·m], (N, n)."""
        return self.friction + self.validation.residual


def predict_recording(estimate: Estimate, recording: Recording) -> RecordingPrediction:
    """Predict the torque of a recording, its prediction band, and its friction."""
    # Torque, friction and band pass the filter of the estimate's preparation.
    if estimate.actuators is not None:
        recording = estimate.actuators.torque(recording)
    recording = for_leg(estimate.model, recording).resampled()
    validation = validate(estimate, recording)
    q, v, a, _ = estimate.preparation.kinematics(recording)
    valid = np.searchsorted(recording.time, validation.time - 0.5 / recording.sample_rate)
    base = base_during(recording, estimate.preparation)
    motion = estimate.model.motion(q, v, a, base, recording.payloads, temperature=recording.temperature)
    friction = estimate.model.friction_torque(motion, estimate.values)[:, estimate.model.leg.base_rows :]
    filtered = estimate.preparation.filter_columns(friction, recording.sample_rate)[valid]
    return RecordingPrediction(recording, q[valid], v[valid], validation, filtered)
