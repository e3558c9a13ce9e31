"""Motion of the base at the samples of a recording, smoothed like the angles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.reduction.planar import GRAVITY
from exoid.leg.torso import MovingBase

from .base_motion import BASE_COLUMNS
from .base_pose import POSE_COLUMNS, twice_imaginary
from .preparation import Preparation
from .recording import Recording

WINDOW, TURNS = 3.0, 2
"""Time over which an accelerometer tells the vertical [s], and turns in which the gyroscope adds what is faster."""


def base_during(recording: Recording, preparation: Preparation) -> MovingBase | None:
    """Compute the motion of the base at the origin of the root link, at the samples of ``recording.resampled()``."""
    # Angular velocity and specific force pass the filter that the angles pass, and ω̇ is derived from the smoothed ω as
    # joint velocities are from angles. Then f(0) = f(r) − ω̇ × r + ω × (ω × (−r)) with the position r of the sensor.
    # A pose passes that filter itself. With position p and unit quaternion h of the base, R its rotation,
    # ω = 2 Im(h* ḣ), ω̇ = 2 Im(h* ḧ) and f = Rᵀ(p̈ − g).
    even = recording.resampled()
    if even.base is None:
        return even.torso
    pose = even.base.pose
    names, columns = (BASE_COLUMNS, even.base.columns) if pose is None else (POSE_COLUMNS, pose.columns)
    signals = Recording(even.time, columns, joint_names=names, source=even.source, largest_angle=math.inf)
    smooth, slope, curvature, _ = preparation.kinematics(signals)
    if pose is None:
        at_sensor = BaseKinematics(smooth[:, :3], slope[:, :3], smooth[:, 3:])
        return replace(at_sensor.moved(-even.base.position), up=vertical(even))
    size = np.linalg.norm(smooth[:, 3:], axis=1, keepdims=True)
    h, rate, change = (part[:, 3:] / size for part in (smooth, slope, curvature))
    force = curvature[:, :3] + (0.0, 0.0, GRAVITY)
    turned = scipy.spatial.transform.Rotation.from_quat(h).apply(force, inverse=True)
    up = scipy.spatial.transform.Rotation.from_quat(h).apply([0.0, 0.0, 1.0], inverse=True)
    return BaseKinematics(twice_imaginary(h, rate), twice_imaginary(h, change), turned, up)


def vertical(recording: Recording) -> FloatArray:
    """Find the direction upwards in the axes of the base, (N, 3): its quick part by the gyroscope, u̇ = −ω × u."""
    base, rate = recording.base, recording.sample_rate
    if base is None:
        return np.tile([0.0, 0.0, 1.0], (len(recording), 1))
    if base.pose is not None:
        return base.pose.rotation[:, 2]
    force, width = base.specific_force / GRAVITY, max(1, round(WINDOW * rate))

    def smooth(x: FloatArray) -> FloatArray:
        once = scipy.ndimage.uniform_filter1d(x, width, axis=0)
        return np.asarray(scipy.ndimage.uniform_filter1d(once, width, axis=0))

    up = smooth(force)
    for _ in range(TURNS):  # what the base turns is taken out of the smoothing
        turned = np.cumsum(np.cross(up, base.angular_velocity), axis=0) / rate
        up = turned + smooth(force - turned)
    return np.asarray(up / np.maximum(np.linalg.norm(up, axis=1, keepdims=True), np.finfo(np.float64).tiny))
