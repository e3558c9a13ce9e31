"""Motion of the base at the samples of a recording, smoothed like the angles."""

from __future__ import annotations

import math

from exoid.base_kinematics import BaseKinematics
from exoid.torso import MovingBase

from .base_motion import BASE_COLUMNS
from .preparation import Preparation
from .recording import Recording


def base_during(recording: Recording, preparation: Preparation) -> MovingBase | None:
    """Compute the motion of the base at the origin of the root link.

    Angular velocity and specific force pass the filter that the angles pass, and ω̇ is derived from the smoothed ω as
    joint velocities are from angles. Then f(0) = f(r) − ω̇ × r + ω × (ω × (−r)) with the position r of the sensor.

    Args:
        recording: The recording.
        preparation: Filter and differentiation.

    Returns:
        Motion at the samples of ``recording.resampled()``; the tilt of the torso for a base that stands still, None if
        it is upright.
    """
    even = recording.resampled()
    if even.base is None:
        return even.torso
    signals = Recording(
        even.time, even.base.columns, joint_names=BASE_COLUMNS, source=even.source, largest_angle=math.inf
    )
    smooth, slope, _, _ = preparation.kinematics(signals)
    at_sensor = BaseKinematics(smooth[:, :3], slope[:, :3], smooth[:, 3:])
    return at_sensor.moved(-even.base.position)
