"""Tree of the bodies of a leg: their links, the placements of the joints on them, and their motion."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, nearest
from exoid.leg.leg import Leg

from .transforms import homogeneous


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Tree of the bodies of a leg. As in Pinocchio, joint j carries body j, and body 0 is the torso."""

    leg: Leg  # the leg

    @cached_property
    def links(self) -> tuple[dict[str, FloatArray], ...]:
        """Links of each body by name, with their placements on the body, (4, 4); other limbs of the torso left out."""
        model = self.leg.model
        bodies: tuple[dict[str, FloatArray], ...] = tuple({} for _ in range(model.njoints))
        links = self._links_of_leg()
        for frame in model.frames:
            if frame.type != pin.FrameType.BODY:
                continue
            name = frame.name if frame.name in links else re.sub(r" \d+$", "", frame.name)
            if name in links:
                bodies[frame.parentJoint][name] = np.asarray(frame.placement.homogeneous)
        return bodies

    @property
    def axes(self) -> FloatArray:
        """Direction of each joint's axis in its own frame, (n, 3)."""
        data = self.leg.model.createData()
        pin.computeJointJacobians(self.leg.model, data, pin.neutral(self.leg.model))
        columns = []
        for j in range(1, self.leg.model.njoints):
            local = pin.getJointJacobian(self.leg.model, data, j, pin.ReferenceFrame.LOCAL)
            J = local.reshape(6, self.leg.model.nv)  # Pinocchio returns a vector for one joint
            column = J[:, self.leg.model.joints[j].idx_v]
            columns.append(column[3:] if np.linalg.norm(column[3:]) > 0.5 else column[:3])
        return np.array(columns)

    @property
    def revolute(self) -> tuple[bool, ...]:
        """Whether each joint is revolute; the others are prismatic."""
        return tuple("JointModelP" not in joint.shortname() for joint in list(self.leg.model.joints)[1:])

    @property
    def parents(self) -> tuple[int, ...]:
        """Index of the body that holds each joint, (n,)."""
        return tuple(self.leg.model.parents)[1:]

    @property
    def placements(self) -> tuple[FloatArray, ...]:
        """Placement of each joint on its parent body, n of (4, 4)."""
        return tuple(np.asarray(p.homogeneous) for p in list(self.leg.model.jointPlacements)[1:])

    def loop_points(self, body: int) -> list[FloatArray]:
        """Points of a body at which loops hold it, in its frame [m], (3,) each."""
        pairs = () if self.leg.closure is None else self.leg.closure.pairs
        origins = {pair.loop: pair for pair in reversed(pairs)}  # further points of a loop hold its directions
        ends = (end for pair in origins.values() for end in zip(pair.bodies, pair.places, strict=True))
        return [place for held, place in ends if held + 1 == body]

    @cached_property
    def reach(self) -> float:
        """Distance from the first joint to the end of the leg [m]."""
        lengths = [0.0]
        for parent, placement in zip(self.parents[1:], self.placements[1:], strict=True):
            lengths.append(lengths[parent - 1] + float(np.linalg.norm(placement[:3, 3])) if parent else 0.0)
        ends = [2.0 * float(np.linalg.norm(self.leg.model.inertias[j + 1].lever)) for j in range(len(lengths))]
        return max(1e-2, *(a + b for a, b in zip(lengths, ends, strict=True)))

    def body_placements(self, q: ArrayLike) -> FloatArray:
        """Placement of every body in the torso's frame at angles (N, n) [rad], the torso first, (N, n + 1, 4, 4)."""
        rotation, translation = self.leg.forward_kinematics(q)
        placements = np.tile(np.eye(4), (len(rotation), len(self.parents) + 1, 1, 1))
        placements[:, 1:, :3, :3], placements[:, 1:, :3, 3] = rotation, translation
        return placements

    def joint_transforms(self, q: ArrayLike) -> FloatArray:
        """Placement of every body in the frame of the joint that carries it, at angles (N, n) [rad], (N, n, 4, 4)."""
        bodies = self.body_placements(q)
        joints = bodies[:, list(self.parents)] @ np.array(self.placements)
        return np.asarray(np.linalg.inv(joints) @ bodies[:, 1:])

    def torso_placement(self, pitch: float) -> FloatArray:
        """Placement of a torso pitched by an angle [rad] about the first joint, (4, 4)."""
        hip = self.placements[0][:3, 3]
        rotation = np.asarray(pin.exp3(-pitch * self.leg.plane.lateral))
        return homogeneous(hip - rotation @ hip, rotation)

    def _links_of_leg(self) -> set[str]:
        """Links above and below the moving joints, and links fixed to those above."""
        joints = [
            (j.get("name", ""), parent.get("link", ""), child.get("link", ""), j.get("type") == "fixed")
            for j in self.leg.description.parse().findall("joint")
            if (parent := j.find("parent")) is not None and (child := j.find("child")) is not None
        ]
        parent_of = {child: parent for _, parent, child, _ in joints}
        moving = {child for name, _, child, _ in joints if name in self.leg.tree_joint_names}
        above: set[str] = set()
        for link in moving:
            ancestor = parent_of.get(link)
            while ancestor is not None:
                above.add(ancestor)
                ancestor = parent_of.get(ancestor)
        below = _with_descendants(moving, [(parent, child) for _, parent, child, _ in joints])
        fixed = [(parent, child) for _, parent, child, is_fixed in joints if is_fixed]
        return below | _with_descendants(above, fixed)


def _with_descendants(links: set[str], pairs: list[tuple[str, str]]) -> set[str]:
    """Links and all their descendants by pairs (parent, child)."""
    found, fresh = set(links), set(links)
    while fresh:
        fresh = {child for parent, child in pairs if parent in fresh} - found
        found |= fresh
    return found


def pose_angles(legs: Sequence[Leg], pose: Mapping[str, float]) -> list[FloatArray]:
    """Angles of the joints of each leg, in their order; zero for joints that are not named."""
    names = [name for leg in legs for name in leg.joint_names]
    unknown = sorted(set(pose) - set(names))
    if unknown:
        remedy = f"{nearest(unknown[0], names)}the joints are {', '.join(names)}"
        raise BadArgumentError(f"no joint {', '.join(unknown)}", remedy=remedy)
    return [np.array([float(pose.get(name, 0.0)) for name in leg.joint_names]) for leg in legs]
