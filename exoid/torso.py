"""A torso that tilts or moves: what the leg hangs from."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import pinocchio as pin

from ._typing import ArrayLike, FloatArray
from .errors import ExoidError
from .reduction import Plane, TorsoSamples

TORSO_JOINTS = 3
"""Forward, up and pitch, in front of the leg's joints."""


@dataclass(frozen=True)
class TorsoMotion:
    """How the torso tilts and moves in the plane of the leg; each entry is a number, or one per sample.

    The base acceleration acts like a changed gravity and the pitch like an offset of the hip angle: the torso adds no
    parameter (doc. 1, end of sec. II-B).

    Attributes:
        pitch: Tilt [rad], positive about −lateral like a positive φ, that is, with the shoulders moving backwards.
        pitch_rate: [rad/s].
        pitch_acceleration: [rad/s²].
        hip_acceleration: Forward and upward acceleration of the first joint's origin [m/s²], (2,) or (N, 2).

    Example:
        >>> tilted = TorsoMotion(pitch=np.deg2rad(20.0))
    """

    pitch: ArrayLike = 0.0
    pitch_rate: ArrayLike = 0.0
    pitch_acceleration: ArrayLike = 0.0
    hip_acceleration: ArrayLike = (0.0, 0.0)

    def samples(self, count: int) -> TorsoSamples:
        """Repeat constants so that every entry has ``count`` samples.

        Raises:
            ExoidError: An entry is not finite or has another number of samples.
        """
        arrays = [np.asarray(getattr(self, field.name), dtype=np.float64) for field in fields(self)]
        try:
            pitch, rate, acceleration = (np.broadcast_to(x, (count,)) for x in arrays[:3])
            hip = np.broadcast_to(arrays[3], (count, 2))
        except ValueError as error:
            raise ExoidError(f"torso motion does not fit {count} samples ({error})") from error
        if not all(np.isfinite(x).all() for x in arrays):
            raise ExoidError("torso motion is not finite", remedy="remove the NaN or infinite samples")
        return TorsoSamples(pitch, rate, acceleration, hip[:, 0], hip[:, 1])


def moving_torso_model(model: pin.Model, plane: Plane) -> pin.Model:
    """Put three joints before the leg's: the hip moves forward and up, and the torso pitches about it."""
    hip = pin.SE3(np.eye(3), model.jointPlacements[1].translation)
    torso = pin.Model()
    joint = torso.addJoint(0, pin.JointModelPrismaticUnaligned(plane.forward), hip, "exoid torso forward")
    joint = torso.addJoint(joint, pin.JointModelPrismaticUnaligned(plane.up), pin.SE3.Identity(), "exoid torso up")
    joint = torso.addJoint(
        joint, pin.JointModelRevoluteUnaligned(-plane.lateral), pin.SE3.Identity(), "exoid torso pitch"
    )
    frame = torso.addFrame(pin.Frame("exoid moving torso", joint, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return pin.appendModel(torso, model, frame, hip.inverse())


def torso_coordinates(torso: TorsoSamples) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions, velocities and accelerations of the three torso joints, (N, 3) each.

    Velocities of translation change no force; they and the displacement are left at zero.
    """
    zero = np.zeros_like(torso.pitch)
    return (
        np.column_stack([zero, zero, torso.pitch]),
        np.column_stack([zero, zero, torso.pitch_rate]),
        np.column_stack([torso.hip_acceleration_x, torso.hip_acceleration_z, torso.pitch_acceleration]),
    )
