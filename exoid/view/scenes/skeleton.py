"""Bodies of a leg: what each joint carries, where the next joints sit, and how it all moves."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.leg import Leg

from .parts import moved


class Motion(NamedTuple):
    """Where each joint stands within its own frame, as three.js writes it.

    Attributes:
        quaternion: (x, y, z, w), (N, n, 4).
        position: [m], (N, n, 3).
    """

    quaternion: FloatArray
    position: FloatArray


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The tree of bodies of a leg. Body 0 is the torso, body j is what joint j carries, as in Pinocchio.

    Attributes:
        leg: The leg.
    """

    leg: Leg

    @cached_property
    def links(self) -> tuple[dict[str, FloatArray], ...]:
        """Links of each body with their places in its frame, (4, 4); without other limbs of the torso."""
        model = self.leg.model
        bodies: tuple[dict[str, FloatArray], ...] = tuple({} for _ in range(model.njoints))
        wanted = self._carrying_or_carried()
        for frame in model.frames:
            if frame.type != pin.FrameType.BODY:
                continue
            name = frame.name if frame.name in wanted else re.sub(r" \d+$", "", frame.name)
            if name in wanted:
                bodies[frame.parentJoint][name] = np.asarray(frame.placement.homogeneous)
        return bodies

    @property
    def axes(self) -> FloatArray:
        """Direction of each joint in its own frame, (n, 3)."""
        data = self.leg.model.createData()
        pin.computeJointJacobians(self.leg.model, data, pin.neutral(self.leg.model))
        columns = []
        for j in range(1, self.leg.model.njoints):
            J = pin.getJointJacobian(self.leg.model, data, j, pin.ReferenceFrame.LOCAL)
            column = J[:, self.leg.model.joints[j].idx_v]
            columns.append(column[3:] if np.linalg.norm(column[3:]) > 0.5 else column[:3])
        return np.array(columns)

    @property
    def turning(self) -> tuple[bool, ...]:
        """Whether each joint is one that turns; others slide."""
        return tuple("JointModelP" not in joint.shortname() for joint in list(self.leg.model.joints)[1:])

    @property
    def parents(self) -> tuple[int, ...]:
        """Body that each joint hangs on, n of them."""
        return tuple(self.leg.model.parents)[1:]

    @property
    def placements(self) -> tuple[FloatArray, ...]:
        """Place of each joint on its parent body, (4, 4), n of them."""
        return tuple(np.asarray(p.homogeneous) for p in list(self.leg.model.jointPlacements)[1:])

    @cached_property
    def reach(self) -> float:
        """How far the leg reaches from its first joint [m]."""
        lengths = [0.0]
        for parent, place in zip(self.parents[1:], self.placements[1:], strict=True):
            lengths.append(lengths[parent - 1] + float(np.linalg.norm(place[:3, 3])) if parent else 0.0)
        coms = [2.0 * float(np.linalg.norm(self.leg.model.inertias[j + 1].lever)) for j in range(len(lengths))]
        return max(1e-2, *(a + b for a, b in zip(lengths, coms, strict=True)))

    def bodies(self, q: ArrayLike) -> FloatArray:
        """Place of every body in the torso's frame, the torso first, (N, n + 1, 4, 4)."""
        rotation, translation = self.leg.forward_kinematics(q)
        places = np.tile(np.eye(4), (len(rotation), len(self.parents) + 1, 1, 1))
        places[:, 1:, :3, :3], places[:, 1:, :3, 3] = rotation, translation
        return places

    def within(self, q: ArrayLike) -> FloatArray:
        """Place of every body that a joint carries in the frame of that joint, (N, n, 4, 4)."""
        places = self.bodies(q)
        joints = places[:, list(self.parents)] @ np.array(self.placements)
        return np.asarray(np.linalg.inv(joints) @ places[:, 1:])

    def motion(self, q: ArrayLike) -> Motion:
        """What each joint does to its body."""
        within = self.within(q)
        rotations = scipy.spatial.transform.Rotation.from_matrix(within[..., :3, :3].reshape(-1, 3, 3))
        return Motion(rotations.as_quat().reshape(*within.shape[:2], 4), within[..., :3, 3])

    def upright(self, pitch: float) -> FloatArray:
        """Place of a torso tilted by ``pitch`` [rad] about the first joint, (4, 4)."""
        lateral = self.leg.chain.plane.lateral if self.leg.chain is not None else np.array([0.0, 1.0, 0.0])
        hip = self.placements[0][:3, 3]
        rotation = np.asarray(pin.exp3(-pitch * lateral))
        return moved(hip - rotation @ hip, rotation)

    def _carrying_or_carried(self) -> set[str]:
        """Links that carry moving joints or are carried by them, and what is fixed to the former."""
        joints = [
            (j.get("name", ""), parent.get("link", ""), child.get("link", ""), j.get("type") == "fixed")
            for j in self.leg.description.parse().findall("joint")
            if (parent := j.find("parent")) is not None and (child := j.find("child")) is not None
        ]
        above = {child: parent for _, parent, child, _ in joints}
        moving = {child for name, _, child, _ in joints if name in self.leg.joint_names}
        carrying: set[str] = set()
        for link in moving:
            carrier = above.get(link)
            while carrier is not None:
                carrying.add(carrier)
                carrier = above.get(carrier)
        carried = _with_all_below(moving, [(parent, child) for _, parent, child, _ in joints])
        fixed = [(parent, child) for _, parent, child, is_fixed in joints if is_fixed]
        return carried | _with_all_below(carrying, fixed)


def _with_all_below(links: set[str], pairs: list[tuple[str, str]]) -> set[str]:
    """Links, and those that hang on them by pairs (parent, child)."""
    found, fresh = set(links), set(links)
    while fresh:
        fresh = {child for parent, child in pairs if parent in fresh} - found
        found |= fresh
    return found


def joint_angles(names: Sequence[str], angles: Mapping[str, float]) -> FloatArray:
    """Angles [rad] of joints in their order, zero where none is given, (n,)."""
    return np.array([float(angles.get(name, 0.0)) for name in names])
