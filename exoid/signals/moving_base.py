"""Motion of the base at the samples of a recording, smoothed like the angles."""

from __future__ import annotations

import math

import numpy as np
import scipy  # its parts load when they are first used

from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.reduction.planar import GRAVITY
from exoid.leg.torso import MovingBase

from .base_motion import BASE_COLUMNS
from .base_pose import POSE_COLUMNS, twice_imaginary
from .preparation import Preparation
from .recording import Recording


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
        return at_sensor.moved(-even.base.position)
    size = np.linalg.norm(smooth[:, 3:], axis=1, keepdims=True)
    h, rate, change = (part[:, 3:] / size for part in (smooth, slope, curvature))
    force = curvature[:, :3] + (0.0, 0.0, GRAVITY)
    turned = scipy.spatial.transform.Rotation.from_quat(h).apply(force, inverse=True)
    return BaseKinematics(twice_imaginary(h, rate), twice_imaginary(h, change), turned)
