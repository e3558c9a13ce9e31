"""Torques that are logged later than the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .recording import Recording


def without_torque_delay(recording: Recording, delays: Mapping[int, float | FloatArray]) -> Recording:
    """Shift torques against the motion.

    Args:
        recording: A recording.
        delays: Time by which the torque of each joint is late [s], by its index; or that of each even time, (N,).

    Returns:
        The recording at even times with torques at t + delay; the first or last value fills the end. Torques that were
        not measured remain so.
    """
    if recording.tau is None:
        return recording
    even = recording.resampled()
    assert even.tau is not None
    tau, measured = even.tau.copy(), even.measured
    for joint in (one for one in delays if measured[one]):
        at = np.clip(even.time + delays[joint], even.time[0], even.time[-1])
        tau[:, joint] = scipy.interpolate.CubicSpline(even.time, even.tau[:, joint])(at)
    return replace(even, tau=tau)
