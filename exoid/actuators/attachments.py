"""Attachment points of a linear actuator on two links: its length and its moment arm."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.description import FARTHEST
from exoid.leg.leg import Leg
from exoid.leg.link_frames import LinkFrame, link_frame
from exoid.leg.model import joint_axis
from exoid.tools.numbers import checked

SHORTEST = 1e-3
"""Shortest length of an actuator, and smallest of its largest moment arms [m]."""


class Attachment(NamedTuple):
    """Point of a link.

    Attributes:
        link: Name of the link, or its label: "thigh" for "left_thigh".
        point: Coordinates in the frame of the link in the URDF [m], (3,).
    """

    link: str
    point: tuple[float, float, float]


class MomentArm:
    """Length and moment arm of a linear actuator as functions of a joint's angle."""

    def on(self, leg: Leg, joint: str) -> MomentArm:
        """Find the geometry around a joint of a leg.

        Args:
            leg: The leg.
            joint: Name of the joint.

        Returns:
            Length and moment arm there.

        Raises:
            ExoidError: The geometry does not fit the joint.
        """
        return self

    def length(self, q: FloatArray) -> FloatArray:
        """Compute the length l, which may lack a constant.

        Args:
            q: Joint angles [rad], (N,).

        Returns:
            Lengths [m], (N,).
        """
        raise NotImplementedError

    def arm(self, q: FloatArray) -> FloatArray:
        """Compute the moment arm r = dl/dq.

        Args:
            q: Joint angles [rad], (N,).

        Returns:
            Moment arms [m], (N,).

        Raises:
            ExoidError: The actuator is not mounted on a leg, or was not measured at these angles.
        """
        raise NotImplementedError


SquaredLength = tuple[float, float, float]
"""Coefficients c0, c1, c2 of the squared length between two points around a joint, c0 + c1 cos q + c2 sin q [m²]."""


@dataclass(frozen=True)
class Attachments(MomentArm):
    """Two attachment points, on links that one turning joint separates: length l(q) and moment arm r(q) = dl/dq.

    Either may be above the joint. With a the point above the joint and b the one below, both in the joint's frame, and
    u its axis, l² = |R(u, q) b − a|² = c₀ + c₁ cos q + c₂ sin q, where c₀ = |a|² + |b|² − 2 (a·u)(b·u),
    c₁ = −2 (a·b − (a·u)(b·u)), c₂ = −2 a·(u × b), and r = (c₂ cos q − c₁ sin q) / 2l.

    Attributes:
        first: One attachment point: name of the link and coordinates [m].
        second: The other.
        squared_length: Coefficients of l² around the joint; None before :meth:`on` mounts the points there.

    Raises:
        ExoidError: A point is not three coordinates in metres.

    Example:
        >>> leg = exoid.load_leg("cuhk")
        >>> knee = Attachments(("thigh", (0.05, 0.0, -0.10)), ("shank", (0.05, 0.0, -0.06))).on(leg, "left_knee")
        >>> print(f"{knee.length(np.array([0.5]))[0]:.3f} m, {knee.arm(np.array([0.5]))[0]:.3f} m")
        0.395 m, 0.022 m
    """

    first: Attachment
    second: Attachment
    squared_length: SquaredLength | None = None

    def __post_init__(self) -> None:
        """Check names and coordinates."""
        for name in ("first", "second"):
            object.__setattr__(self, name, _attachment(getattr(self, name)))

    def on(self, leg: Leg, joint: str) -> Attachments:
        """Find the geometry of both points around a joint, which separates their links."""
        model = leg.model
        moving = model.getJointId(joint)
        places = [_place(leg, attachment) for attachment in (self.first, self.second)]
        joints = [frame.body + 1 for frame in places]
        if sorted(joints) != [model.parents[moving], moving]:
            between = sorted(set(model.supports[joints[0]]) ^ set(model.supports[joints[1]]))  # outwards
            named = ", ".join(str(model.names[k]) for k in between) or "no joint"
            raise BadArgumentError(
                f"{self.first.link} and {self.second.link} are separated by {named}, and the actuator is at {joint}",
                remedy="attach it to the links above and below that one joint; an actuator across several joints is "
                "none of exoid's",
            )
        points = [
            frame.placement.act(np.array(attachment.point))
            for frame, attachment in zip(places, (self.first, self.second), strict=True)
        ]
        above, below = points if joints[1] == moving else points[::-1]
        above = model.jointPlacements[moving].actInv(above)
        turn = joint_axis(model.joints[moving])[3:]
        if not turn.any():
            raise BadArgumentError(f"attachment points at {joint}, which slides", remedy="give a table of moment arms")
        along = float(above @ turn) * float(below @ turn)
        c0, c1 = float(above @ above + below @ below) - 2.0 * along, -2.0 * (float(above @ below) - along)
        mounted = replace(self, squared_length=(c0, c1, -2.0 * float(above @ np.cross(turn, below))))
        turned = np.linspace(-math.pi, math.pi, 361)
        if mounted.length(turned).min() < SHORTEST:
            raise BadArgumentError(
                f"the attachment points at {joint} meet at some angle", remedy="check their coordinates"
            )
        if np.abs(mounted.arm(turned)).max() < SHORTEST:
            raise BadArgumentError(
                f"the attachment points give no moment arm about {joint}: one of them is on its axis",
                remedy="check their coordinates, which are in the frames of the links",
            )
        return mounted

    def length(self, q: FloatArray) -> FloatArray:
        """Compute l = √(c₀ + c₁ cos q + c₂ sin q)."""
        c0, c1, c2 = self._mounted
        return np.asarray(np.sqrt(np.maximum(c0 + c1 * np.cos(q) + c2 * np.sin(q), 0.0)))

    def arm(self, q: FloatArray) -> FloatArray:
        """Compute r = (c₂ cos q − c₁ sin q) / 2l."""
        _, c1, c2 = self._mounted
        return np.asarray(0.5 * (c2 * np.cos(q) - c1 * np.sin(q)) / np.maximum(self.length(q), SHORTEST))

    @property
    def _mounted(self) -> SquaredLength:
        if self.squared_length is None:
            raise BadArgumentError(
                "the attachment points of a linear actuator have no moment arm without their leg",
                remedy='mount it: actuator.on(leg, "left_knee"), or Actuators.of(leg, {"left_knee": actuator})',
            )
        return self.squared_length


def _attachment(given: object) -> Attachment:
    """Make an attachment of a link's name and three coordinates."""
    if not isinstance(given, tuple | list) or len(given) != 2 or not isinstance(given[0], str):
        remedy = 'give link and point [m]: ("thigh", (0.05, 0.0, -0.1))'
        raise BadArgumentError(f"an attachment is {given!r}", remedy=remedy)
    link, point = given[0], checked(given[1], f"the point on {given[0]} [m]", least=-FARTHEST, most=FARTHEST)
    if point.shape != (3,):
        what = f"a point on {link} with coordinates {point.tolist()}"
        raise BadArgumentError(what, remedy="give x, y, z in m in the frame of the link")
    return Attachment(link, (float(point[0]), float(point[1]), float(point[2])))


def _place(leg: Leg, attachment: Attachment) -> LinkFrame:
    """Frame of the link of an attachment, which may be named without its side."""
    sides = dict(zip(leg.link_labels, leg.link_names, strict=True))
    named = {leg.description.root_link, *leg.description.child_links.values()}
    link = attachment.link if attachment.link in named else sides.get(attachment.link, attachment.link)
    return link_frame(leg.model, leg.description, link)
