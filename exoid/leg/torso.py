"""Motion of the base of the leg: torso tilt and acceleration in the plane of the leg, or any motion in space."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError

from .base_kinematics import BaseKinematics
from .reduction import Plane
from .reduction.planar import GRAVITY, TorsoSamples


@dataclass(frozen=True, repr=False)
class TorsoMotion:
    """Motion of the torso in the plane of the leg; each entry is a number, or one per sample.

    The acceleration of the base has the effect of a changed gravity, and the pitch that of an offset of the hip angle.
    The torso therefore adds no parameter (doc. 1, end of sec. II-B).

    Attributes:
        pitch: Tilt [rad], () or (N,), positive about −lateral like a positive φ: the shoulders move backwards.
        pitch_rate: Rate of the tilt [rad/s], () or (N,).
        pitch_acceleration: Acceleration of the tilt [rad/s²], () or (N,).
        hip_acceleration: Forward and upward acceleration of the first joint's origin [m/s²], (2,) or (N, 2).

    Example:
        >>> TorsoMotion(pitch=0.35)
        TorsoMotion(pitch=0.35)
    """

    pitch: ArrayLike = 0.0
    pitch_rate: ArrayLike = 0.0
    pitch_acceleration: ArrayLike = 0.0
    hip_acceleration: ArrayLike = (0.0, 0.0)

    def samples(self, count: int) -> TorsoSamples:
        """Repeat constants so that every entry has one value per sample.

        Args:
            count: Number of samples, N.

        Returns:
            Motion of the torso at each sample.

        Raises:
            ExoidError: An entry is not finite or has another number of samples.
        """
        try:
            arrays = [np.asarray(getattr(self, field.name), dtype=np.float64) for field in fields(self)]
            pitch, rate, acceleration = (np.broadcast_to(x, (count,)) for x in arrays[:3])
            hip = np.broadcast_to(arrays[3], (count, 2))
        except (TypeError, ValueError) as error:
            raise BadArgumentError(f"torso motion does not fit {count} samples ({error})") from error
        if not all(np.isfinite(x).all() for x in arrays):
            raise BadArgumentError("torso motion is not finite", remedy="remove the NaN or infinite samples")
        return TorsoSamples(pitch, rate, acceleration, hip[:, 0], hip[:, 1])

    def __repr__(self) -> str:
        """Write the entries that are not zero in one line: numbers, or the shape of an array."""
        entries = []
        for field in fields(self):
            values = np.asarray(getattr(self, field.name))
            if np.any(values):
                shown = values.tolist() if values.size <= 2 else f"<array of shape {values.shape}>"
                entries.append(f"{field.name}={shown}")
        return f"TorsoMotion({', '.join(entries)})"


MovingBase = TorsoMotion | BaseKinematics
"""Motion of what carries the leg: in the plane of the leg, or in space."""


def base_kinematics(base: MovingBase, count: int, plane: Plane, hip: FloatArray) -> BaseKinematics:
    """Write a motion of the torso as one in space."""
    if isinstance(base, BaseKinematics):
        if len(base) != count:
            raise BadArgumentError(
                f"the base has {len(base)} samples, the joints {count}", remedy="give one for each sample"
            )
        return base
    torso = base.samples(count)
    forward = torso.hip_acceleration_x[:, None] * plane.forward
    up = (torso.hip_acceleration_z + GRAVITY)[:, None] * plane.up
    cosine, sine = np.cos(torso.pitch)[:, None], np.sin(torso.pitch)[:, None]
    across = np.cross(plane.lateral, forward + up)
    at_hip = BaseKinematics(
        -torso.pitch_rate[:, None] * plane.lateral,
        -torso.pitch_acceleration[:, None] * plane.lateral,
        cosine * (forward + up) + sine * across,
    )
    return at_hip.moved(-hip)


def tilted_gravity(plane: Plane, pitch: float) -> FloatArray:
    """Gravity in the axes of a tilted torso [m/s²], (3,)."""
    return np.asarray(-base_kinematics(TorsoMotion(pitch), 1, plane, np.zeros(3)).specific_force[0])
