"""Motion of a base that a foot on level ground carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import ArrayLike

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.leg.model import joint_axis
from exoid.signals import BaseMotion, Recording
from exoid.signals.link_wrenches import link_placements


def level_rotation(leg: Leg, link: str) -> FloatArray:
    """Level axes from a link, (3, 3), where all joint angles are zero and the base is upright: flat on the ground."""
    return np.asarray(link_placements(leg, np.zeros((1, len(leg.joint_names))), link).rotation[0])


CUTOFF = 15.0
"""Cut-off frequency of the motion [Hz], above that of the filter that follows."""

LEVEL = np.deg2rad(0.5)
"""Standard deviation of the lean of ground that is taken for level, about each axis [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class StandingBase(BaseMotion):
    """Motion of the base that was not measured: joint angles say it while a link rests."""

    link: str = ""  # link that rests


def standing_base(
    leg: Leg, recording: Recording, link: str, compliance: float = 0.0, lean: ArrayLike = (0.0, 0.0, 0.0)
) -> StandingBase:
    """Derive the motion of the base from the joint angles while a link rests flat on ground that leans little."""
    # The link stands as it does where all joints of the URDF are at zero and the base is upright. Elsewhere the result
    # has no meaning. On a soft sole it tilts by c τ about the axis of the joint that carries it, whose torque τ is the
    # moment of the ground on it but for the weight of the foot. The ground itself leans by a rotation vector [rad].
    rotation, position = link_placements(leg, recording.q, link)
    turn = level_rotation(leg, link) @ np.swapaxes(rotation, 1, 2)  # laboratory from base
    if compliance:
        turn = _tilts(leg, recording, link, compliance) @ turn
    turn = scipy.spatial.transform.Rotation.from_rotvec(np.asarray(lean, dtype=np.float64)).as_matrix() @ turn
    place = -np.einsum("nij,nj->ni", turn, position)
    quaternion = scipy.spatial.transform.Rotation.from_matrix(turn).as_quat()
    cutoff = min(0.2 * recording.sample_rate, CUTOFF)
    found = BaseMotion.from_pose(place, quaternion, recording.time, cutoff=cutoff)
    return StandingBase(found.angular_velocity, found.specific_force, found.position, found.pose, link=link)


def _tilts(leg: Leg, recording: Recording, link: str, compliance: float) -> FloatArray:
    """Rotations of a foot by the torque of the joint that carries it, in level axes, (N, 3, 3)."""
    body, _ = link_frame(leg.model, leg.description, link)
    tau = recording.tau
    if body < 0 or tau is None:
        return np.broadcast_to(np.eye(3), (len(recording), 3, 3))
    level = leg.forward_kinematics(np.zeros((1, len(leg.joint_names)))).rotation[0, body]
    axis = level @ joint_axis(leg.model.joints[body + 1])[3:]
    angle = compliance * np.where(np.isfinite(tau[:, body]), tau[:, body], 0.0)
    return np.asarray(scipy.spatial.transform.Rotation.from_rotvec(angle[:, np.newaxis] * axis).as_matrix())


def standing_reading(
    leg: Leg, recording: Recording, link: str, position: FloatArray, lean: ArrayLike = (0.0, 0.0, 0.0)
) -> BaseMotion:
    """Derive what an inertial measurement unit measures while a link rests flat on ground that leans little."""
    true = standing_base(leg, recording, link, lean=lean)
    omega = true.angular_velocity
    alpha = np.gradient(omega, recording.time, axis=0)
    force = true.specific_force + np.cross(alpha, position) + np.cross(omega, np.cross(omega, position))
    return BaseMotion(omega, force, position)
