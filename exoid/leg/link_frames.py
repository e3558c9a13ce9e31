"""Frame of a link of the URDF: the joint whose body carries it, and its place there."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, nearest

from .description import Description
from .dynamics import joint_frames
from .leg_data import LegData
from .reduction import Plane


class LinkFrame(NamedTuple):
    """Frame of a link."""

    body: int  # index of the joint that carries the link, −1 for the root link and links that are fixed to it
    placement: pin.SE3  # place of the link in the frame of that joint, or of the root link


def link_frame(model: pin.Model, description: Description, link: str) -> LinkFrame:
    """Find the frame of a link, which may be the root link, or one fixed to another link."""
    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    numbered = re.compile(rf"{re.escape(str(link))} \d+")  # a link with the name of a joint, see build_model
    same = [frame for frame in bodies if frame.name == link] or [f for f in bodies if numbered.fullmatch(f.name)]
    if not same:
        names = [element.get("name", "") for element in description.parse().findall("link")]
        remedy = f"{nearest(str(link), names)}it has {', '.join(names)}"
        raise BadArgumentError(f"no link {link!r} in the URDF", where=description.name, remedy=remedy)
    return LinkFrame(same[0].parentJoint - 1, same[0].placement.copy())


def held_directions(model: pin.Model, description: Description, link: str, plane: Plane) -> FloatArray:
    """Turn a link's twist into axes that point forward, sideward and up at the zero pose, (6, 6)."""
    body, placement = link_frame(model, description, link)
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    turn = np.stack([plane.forward, plane.lateral, plane.up]) @ (data.oMi[body + 1] * placement).rotation
    turning = turn * np.array([[1.0], [-1.0], [1.0]])  # the pitch is positive about the negative lateral axis
    return np.block([[turn, np.zeros((3, 3))], [np.zeros((3, 3)), turning]])


def ball_radius(leg: LegData, link: str) -> float:
    """Radius of a link that rolls on the ground [m]; zero for all others."""
    radius = leg.contacts.get(link, 0.0)
    return 0.0 if isinstance(radius, str) else radius


def lowest_point(leg: LegData, q: ArrayLike, link: str, up: FloatArray | None = None) -> FloatArray:
    """Point of a ball that touches the ground, p = −r Rᵀ u, in the axes of the link, (N, 3); or the origin, (3,)."""
    if not (radius := ball_radius(leg, link)):
        return np.zeros(3)
    body, placement = link_frame(leg.model, leg.description, link)
    axes = joint_frames(leg.model, leg.tree_motion(*leg.samples(q)).q.T).rotation[body]
    upwards = axes[2].T if up is None else np.einsum("ijn,ni->nj", axes, up)
    return np.asarray(-radius * upwards @ placement.rotation)
