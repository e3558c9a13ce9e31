"""Torques that are logged later than the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.tools.numbers import checked

from .recording import Recording

DRIVE_CHANNELS = ("current", "force", "motor_torque", "motor_angle")
"""Quantities that drives measure; they are as late as the torque."""


def without_torque_delay(
    recording: Recording, delays: Mapping[int, float | FloatArray], *, readings: bool = False
) -> Recording:
    """Shift torques against the motion.

    Args:
        recording: A recording.
        delays: Time by which the torque of each joint is late [s], by its index; or that of each even time, (N,).
        readings: Whether to shift what the drives measured, too.

    Returns:
        The recording at even times with torques at t + delay; the end has its last value. NaN remains NaN.
    """
    shifted, even = {}, recording.resampled()
    late = ("tau", *DRIVE_CHANNELS) if readings else ("tau",)
    for quantity in (one for one in late if getattr(recording, one) is not None):
        values = shifted[quantity] = getattr(even, quantity).copy()
        for joint in (one for one in delays if not np.isnan(values[0, one])):
            at = np.clip(even.time + checked(delays[joint], "a torque delay [s]"), even.time[0], even.time[-1])
            values[:, joint] = scipy.interpolate.CubicSpline(even.time, values[:, joint])(at)
    return replace(even, **shifted) if shifted else recording
