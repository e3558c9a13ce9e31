"""Motion of a base that a foot on level ground carries."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import ArrayLike

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.leg.model import joint_axis
from exoid.signals import BaseMotion, Recording
from exoid.signals.link_wrenches import link_placements


def level_rotation(leg: Leg, link: str) -> FloatArray:
    """Level axes from a link, (3, 3), where all joint angles are zero and the base is upright: flat on the ground."""
    return np.asarray(link_placements(leg, np.zeros((1, len(leg.joint_names))), link).rotation[0])


LEVEL = np.deg2rad(0.5)
"""Standard deviation of the lean of ground that is taken for level, about each axis [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class StandingBase(BaseMotion):
    """Motion of the base that was not measured: joint angles say it while a link rests."""

    link: str = ""  # link that rests


def standing_base(
    leg: Leg, recording: Recording, link: str, lean: ArrayLike = (0.0, 0.0, 0.0), pivot: FloatArray | None = None
) -> StandingBase:
    """Derive the motion of the base from the joint angles while a link rests flat on ground that leans little."""
    # The link stands as it does where all joints of the URDF are at zero and the base is upright. Elsewhere the result
    # has no meaning. It leans by a rotation vector [rad], (3,) or (N, 3), in level axes. A foot that leans otherwise at
    # each time turns about a pivot, a place from the origin of the link in level axes [m].
    rotation, position = link_placements(leg, recording.q, link)
    leans = scipy.spatial.transform.Rotation.from_rotvec(np.asarray(lean, dtype=np.float64)).as_matrix()
    turn = leans @ level_rotation(leg, link) @ np.swapaxes(rotation, 1, 2)  # laboratory from base
    place = -np.einsum("nij,nj->ni", turn, position)
    if pivot is not None:
        place += pivot - leans @ pivot
    quaternion = scipy.spatial.transform.Rotation.from_matrix(turn).as_quat()
    cutoff = min(0.2 * recording.sample_rate, 15.0)  # [Hz], above that of the filter that follows
    try:
        found = BaseMotion.from_pose(place, quaternion, recording.time, cutoff=cutoff)
    except BadArgumentError:  # only a jump of an angle turns a base so fast
        row, joint = divmod(int(np.argmax(np.abs(np.diff(recording.q, axis=0)))), recording.q.shape[1])
        name, when = recording.joint_names[joint], recording.time[row + 1]
        what = f"the angle of {name} jumps at {when:.4g} s: its encoder slipped, or was frozen before"
        remedy = "use the part of the log before or after it (Recording.between, --start, --stop)"
        raise UnreadableInputError(what, where=recording.file_name, remedy=remedy, joints=(name,)) from None
    return StandingBase(found.angular_velocity, found.specific_force, found.position, found.pose, link=link)


def tilt_of_sole(leg: Leg, recording: Recording, link: str) -> FloatArray:
    """Find how a sole of unit compliance leans, rotation vectors in level axes [N·m], (N, 3)."""
    # On a soft sole the foot leans by c τ about the axis of the joint that carries it, whose torque τ is the moment of
    # the ground on it but for the weight of the foot.
    body, _ = link_frame(leg.model, leg.description, link)
    if body < 0 or recording.tau is None:
        return np.zeros((len(recording), 3))
    level = leg.forward_kinematics(np.zeros((1, len(leg.joint_names)))).rotation[0, body]
    return np.outer(np.nan_to_num(recording.tau[:, body]), level @ joint_axis(leg.model.joints[body + 1])[3:])


def standing_reading(leg: Leg, recording: Recording, link: str, position: FloatArray) -> StandingBase:
    """Derive what an inertial measurement unit measures while a link rests flat on level ground."""
    true = standing_base(leg, recording, link)
    omega = true.angular_velocity
    alpha = np.gradient(omega, recording.time, axis=0)
    force = true.specific_force + np.cross(alpha, position) + np.cross(omega, np.cross(omega, position))
    return replace(true, specific_force=force, position=position)
