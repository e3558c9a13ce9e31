"""Placeholders for bodies without visuals in the URDF: a hub at the joint, and bars to the next joints."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .skeleton import Skeleton
from .transforms import align_z, homogeneous
from .visual import Material, Visual, box, cylinder

BAR, FRAME = Material("#b3b8bf"), Material("#4a4e55")
"""Materials of bars, and of ends of loops."""


def body_placeholder(skeleton: Skeleton, body: int, colour: str) -> list[Visual]:
    """Make a hub in the colour of the joint, and bars to the next joints or through the centre of mass."""
    longest = max((float(np.linalg.norm(place[:3, 3])) for place in skeleton.placements[1:]), default=0.0)
    size = longest if longest > 0.1 * skeleton.reach else skeleton.reach  # of a segment [m]
    axis = skeleton.axes[body - 1]
    hub = cylinder(0.1 * size, 0.14 * size, Material(colour)).placed(homogeneous(np.zeros(3), align_z(axis)))
    return [hub, *(_bar(end, axis, size) for end in _segment_ends(skeleton, body, size))]


def _segment_ends(skeleton: Skeleton, body: int, size: float) -> list[FloatArray]:
    """Ends of a body in its frame [m]: the next joints, or a point beyond the centre of mass; and ends of loops."""
    pairs = zip(skeleton.parents, skeleton.placements, strict=True)
    held = (place[:3, 3] for parent, place in pairs if parent == body)
    joints = [place for place in held if np.linalg.norm(place) > 0.05 * size]
    lever = np.asarray(skeleton.leg.model.inertias[body].lever)
    beyond = 2.0 * lever if np.linalg.norm(lever) > 0.02 * size else np.array([0.0, 0.0, -0.25 * size])
    return [*(joints or [beyond]), *skeleton.loop_points(body)]


def _bar(end: FloatArray, axis: FloatArray, size: float) -> Visual:
    """Make a bar from the joint to a point of the body."""
    length = float(np.linalg.norm(end))
    return box((0.09 * size, 0.055 * size, length), BAR).placed(homogeneous(0.5 * end, align_z(end, axis)))
