"""What a report knows of a recording."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate, Validation, validate
from exoid.regression.intervals import half_width
from exoid.regression.rows import for_leg
from exoid.signals import Recording

LEVEL = 0.95
"""Probability of bands."""


class Evidence(NamedTuple):
    """A recording, the motion in it, and how well its torque is predicted, (N, n) each.

    Attributes:
        recording: At even time stamps.
        q: Angles [rad].
        v: Velocities [rad/s].
        validation: Measured and predicted torque.
        half_width: Of the band around the prediction in which a newly measured torque is expected [N·m].
        friction: Part of the prediction that is friction [N·m].
    """

    recording: Recording
    q: FloatArray
    v: FloatArray
    validation: Validation
    half_width: FloatArray
    friction: FloatArray

    @property
    def inside(self) -> FloatArray:
        """Share of the measured torques that are within the band, (n,)."""
        return np.asarray((np.abs(self.validation.residual) <= self.half_width).mean(axis=0))

    @property
    def measured_friction(self) -> FloatArray:
        """Measured torque less all of the prediction that is not friction [N·m]."""
        return self.friction + self.validation.residual


def gather(estimate: Estimate, recording: Recording) -> Evidence:
    """Predict the torque of a recording, with what a band around it and its friction are.

    The width is that of unfiltered columns: where friction changes sign within a sample it is a little too wide. All
    else has passed the filter that the torque has passed.

    Raises:
        ExoidError: The recording lacks torque or a joint of the leg.
    """
    recording = for_leg(estimate.model, recording).resampled()
    validation = validate(estimate, recording)
    q, v, a, valid = estimate.preparation.kinematics(recording)
    std = estimate.torque_std(q, v, a, recording.torso, measured=True)[valid]
    half = half_width(LEVEL, estimate.dof) * std
    friction = estimate.model.friction_torque(estimate.model.motion(q, v, a, recording.torso), estimate.values)
    filtered = estimate.preparation.filter_columns(friction, recording.sample_rate)[valid]
    return Evidence(recording, q[valid], v[valid], validation, half, filtered)
