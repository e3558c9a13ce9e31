"""A recording and the torque that an estimate predicts for it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate, Validation, validate
from exoid.regression.intervals import half_width
from exoid.regression.rows import for_leg
from exoid.signals import Recording

LEVEL = 0.95
"""Probability that the prediction band contains a newly measured torque."""


class RecordingPrediction(NamedTuple):
    """A recording, its motion, and its predicted torque with a prediction band and the part that is friction.

    Attributes:
        recording: Recording at even time stamps.
        q: Angles [rad], (N, n).
        v: Velocities [rad/s], (N, n).
        validation: Measured and predicted torque.
        band_half_width: Half the width of the prediction band [N·m], (N, n).
        friction: Friction terms of the predicted torque [N·m], (N, n).
    """

    recording: Recording
    q: FloatArray
    v: FloatArray
    validation: Validation
    band_half_width: FloatArray
    friction: FloatArray

    @property
    def coverage(self) -> FloatArray:
        """Share of the measured torques within the band, (n,)."""
        return np.asarray((np.abs(self.validation.residual) <= self.band_half_width).mean(axis=0))

    @property
    def measured_friction(self) -> FloatArray:
        """Measured torque less all predicted torque except friction [N·m], (N, n)."""
        return self.friction + self.validation.residual


def predict_recording(estimate: Estimate, recording: Recording) -> RecordingPrediction:
    """Predict the torque of a recording, its prediction band, and its friction.

    Torque and friction pass the filter of the estimate's preparation. The band does not: where friction changes sign
    within a sample it is slightly too wide.

    Args:
        estimate: The estimate.
        recording: Recording with torque.

    Returns:
        Motion, torque, band and friction at the samples that the filter leaves valid.

    Raises:
        ExoidError: The recording lacks torque or a joint of the leg.
    """
    recording = for_leg(estimate.model, recording).resampled()
    validation = validate(estimate, recording)
    q, v, a, inner = estimate.preparation.kinematics(recording)
    valid = np.zeros(len(recording), dtype=np.bool_)
    valid[inner] = True if recording.mask is None else recording.mask[inner]
    std = estimate.torque_std(q, v, a, recording.torso, measured=True)[valid]
    half = half_width(LEVEL, estimate.dof) * std
    friction = estimate.model.friction_torque(estimate.model.motion(q, v, a, recording.torso), estimate.values)
    filtered = estimate.preparation.filter_columns(friction, recording.sample_rate)[valid]
    return RecordingPrediction(recording, q[valid], v[valid], validation, half, filtered)
