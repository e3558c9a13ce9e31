"""Placeholders for bodies without visuals in the URDF: bars, joint housings, a foot."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .skeleton import Skeleton
from .transforms import align_z, homogeneous
from .visual import Material, Visual, box, cylinder

BAR, FRAME, RUBBER = Material("#b3b8bf"), Material("#4a4e55"), Material("#1c1d20")
"""Materials of bars, of joint housings, and of soles."""


def body_placeholder(skeleton: Skeleton, body: int, colour: str) -> list[Visual]:
    """Make a joint housing, and bars to the next joints or through the centre of mass."""
    leg, size = skeleton.leg, _segment_length(skeleton)
    axis = skeleton.axes[body - 1]
    at_joint = homogeneous(np.zeros(3), align_z(axis))
    visuals = [
        cylinder(0.115 * size, 0.13 * size, FRAME).placed(at_joint),
        cylinder(0.075 * size, 0.145 * size, Material(colour)).placed(at_joint),
    ]
    names = (leg.tree_joint_names[body - 1] + leg.bodies[body - len(leg.tree_joint_names) - 1]).lower()
    # Words in the name of a link or joint that identify the last body as a foot.
    if not next_joints(skeleton, body) and any(word in names for word in ("foot", "ankle", "toe", "sole")):
        return [*visuals, *_foot(skeleton, body, size)]
    return [*visuals, *(_bar(end, axis, size) for end in segment_ends(skeleton, body))]


def next_joints(skeleton: Skeleton, body: int) -> list[FloatArray]:
    """Joints on a body that are not at its own joint, in its frame [m], (3,) each."""
    far = 0.05 * _segment_length(skeleton)
    pairs = zip(skeleton.parents, skeleton.placements, strict=True)
    return [place[:3, 3] for parent, place in pairs if parent == body and np.linalg.norm(place[:3, 3]) > far]


def segment_ends(skeleton: Skeleton, body: int) -> list[FloatArray]:
    """Ends of a body in its frame [m]: the next joints, or a point beyond the centre of mass; and ends of loops."""
    lever, size = np.asarray(skeleton.leg.model.inertias[body].lever), _segment_length(skeleton)
    beyond = 2.0 * lever if np.linalg.norm(lever) > 0.02 * size else 0.25 * size * _down(skeleton, body)
    return [*(next_joints(skeleton, body) or [beyond]), *skeleton.loop_points(body)]


def torso_placeholder(skeleton: Skeleton) -> list[Visual]:
    """Make a socket for the first joint."""
    place, size = skeleton.placements[0], _segment_length(skeleton)
    axes = align_z(place[:3, :3] @ skeleton.axes[0])
    return [cylinder(0.16 * size, 0.1 * size, FRAME).placed(homogeneous(place[:3, 3], axes))]


def _bar(end: FloatArray, axis: FloatArray, size: float) -> Visual:
    """Make a bar from the joint to a point of the body."""
    length = float(np.linalg.norm(end))
    return box((0.09 * size, 0.055 * size, length), BAR).placed(homogeneous(0.5 * end, align_z(end, axis)))


def _foot(skeleton: Skeleton, body: int, size: float) -> list[Visual]:
    """Make a sole below the joint that points along x of the URDF, or backwards if the mass is there."""
    down = _down(skeleton, body)
    rotation = _placement_at_zero(skeleton, body)[:3, :3]
    forward = rotation.T @ skeleton.leg.plane.forward
    if forward @ skeleton.leg.model.inertias[body].lever < -0.02 * size:
        forward = -forward
    axes = align_z(-down, np.cross(-down, forward))
    height = 0.24 * size
    ankle = box((0.1 * size, 0.05 * size, height), FRAME)
    sole = box((0.6 * size, 0.22 * size, 0.04 * size), RUBBER)
    return [
        ankle.placed(homogeneous(0.5 * height * down, axes)),
        sole.placed(homogeneous(height * down + 0.14 * size * forward, axes)),
    ]


def _down(skeleton: Skeleton, body: int) -> FloatArray:
    """Direction of gravity in a body's frame with all joints at zero, (3,)."""
    gravity = _placement_at_zero(skeleton, body)[:3, :3].T @ skeleton.leg.model.gravity.linear
    return np.asarray(gravity / max(float(np.linalg.norm(gravity)), 1e-9))


def _placement_at_zero(skeleton: Skeleton, body: int) -> FloatArray:
    """Placement of a body in the torso's frame with all joints at zero, (4, 4)."""
    return np.asarray(skeleton.body_placements(np.zeros(len(skeleton.leg.joint_names)))[0, body])


def _segment_length(skeleton: Skeleton) -> float:
    """Typical length of a segment [m]."""
    lengths = [float(np.linalg.norm(placement[:3, 3])) for placement in skeleton.placements[1:]]
    longest = max(lengths, default=0.0)
    return longest if longest > 0.1 * skeleton.reach else skeleton.reach
