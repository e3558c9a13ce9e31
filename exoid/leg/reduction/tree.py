"""Tree of joints: axes and placements, for batched columns of the regressor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.leg.model import joint_axis

TOLERANCE = 1e-12
"""Largest error of an axis that counts as one of x, y, z."""

FREE_FLYER = "JointModelFreeFlyer"
"""Pinocchio's name of a joint of six degrees of freedom."""

BASE_ROWS = 6
"""Rows of a floating base: force and torque."""


class TreeJoint(NamedTuple):
    """Joint of one degree of freedom, and the body that it carries."""

    # Motion vectors are linear before angular, as in Pinocchio.

    parent: int  # index of the body before it; −1 for the base
    turns: bool  # whether it is revolute; otherwise it is prismatic
    axis: int  # axis of the joint, 0 to 2 for x, y, z of the frame behind `into`
    sign: float  # sign of that axis
    into: FloatArray  # motion vectors of the parent into the frame of the joint at zero, (6, 6)
    # motion vectors into the axes of the body if the joint's axis is oblique there, (6, 6); None otherwise
    after: FloatArray | None
    carriers: tuple[int, ...]  # rows of the joints that carry the body, itself included, in ascending order

    @property
    def own_axis(self) -> FloatArray:
        """Motion vector of a unit rate of the joint, (6,)."""
        own = np.zeros(6)
        own[(3 if self.turns else 0) + self.axis] = self.sign
        return own


@dataclass(frozen=True, eq=False)
class Tree:
    """Geometry of a tree of revolute and prismatic joints, on a base that stands or floats."""

    joints: tuple[TreeJoint, ...]  # the joints, parents first
    gravity: FloatArray  # gravity in the axes of the base [m/s²], (3,)
    floating: bool  # whether the base is a body too, with six rows and ten parameters before those of the joints

    @classmethod
    def from_model(cls, model: pin.Model) -> Tree:
        """Read the geometry from a model."""
        floating = is_floating(model)
        base = tuple(range(BASE_ROWS)) if floating else ()
        joints: list[TreeJoint] = []
        for j in range(1 + floating, model.njoints):
            axis = joint_axis(model.joints[j])
            if axis[:3].any() == axis[3:].any():
                raise NotSupportedError(f"joint {model.names[j]!r} is neither revolute nor prismatic")
            parent = model.parents[j] - 1 - floating
            carriers = (*(base if parent < 0 else joints[parent].carriers), model.idx_vs[j])
            joints.append(_joint(parent, axis, model.jointPlacements[j].inverse().action, carriers))
        return cls(tuple(joints), model.gravity.linear.copy(), floating)

    @property
    def rows(self) -> int:
        """Number of rows of the regressor, one for each degree of freedom."""
        return len(self.joints) + BASE_ROWS * self.floating

    @property
    def bodies(self) -> int:
        """Number of bodies, each with ten parameters."""
        return len(self.joints) + self.floating


def is_floating(model: pin.Model) -> bool:
    """Whether the first joint of a model is a free-flyer."""
    return bool(model.njoints > 1 and model.joints[1].shortname() == FREE_FLYER)


def _joint(parent: int, motion: FloatArray, into: FloatArray, carriers: tuple[int, ...]) -> TreeJoint:
    """Make a joint of its motion vector (6,); an oblique axis becomes z between two constant rotations."""
    turns = bool(motion[3:].any())
    direction = motion[3:] if turns else motion[:3]
    axis = int(np.argmax(np.abs(direction)))
    sign = float(np.sign(direction[axis]))
    if np.abs(direction - sign * np.eye(3)[axis]).max() <= TOLERANCE:
        return TreeJoint(parent, turns, axis, sign, into, None, carriers)
    rotation = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), direction).matrix()
    after = pin.SE3(rotation, np.zeros(3)).action
    return TreeJoint(parent, turns, 2, 1.0, after.T @ into, after, carriers)
