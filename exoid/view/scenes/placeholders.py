"""Placeholders for bodies without visuals in the URDF: a hub at the joint, and bars to the next joints."""

from __future__ import annotations

import numpy as np

from .skeleton import Skeleton
from .transforms import align_z, homogeneous
from .visual import Material, Visual, box, cylinder

BAR, FRAME = Material("#b3b8bf"), Material("#4a4e55")
"""Materials of bars, and of ends of loops."""


def body_placeholder(skeleton: Skeleton, body: int, colour: str) -> list[Visual]:
    """Make a hub in the colour of the joint, and bars to the next joints, or the centre of mass, and loops."""
    longest = max((float(np.linalg.norm(place[:3, 3])) for place in skeleton.placements[1:]), default=0.0)
    size = longest if longest > 0.1 * skeleton.reach else skeleton.reach  # of a segment [m]
    axis = skeleton.axes[body - 1]
    hub = cylinder(0.1 * size, 0.14 * size, Material(colour)).placed(homogeneous(np.zeros(3), align_z(axis)))
    pairs = zip(skeleton.parents, skeleton.placements, strict=True)
    held = (place[:3, 3] for parent, place in pairs if parent == body)
    joints = [place for place in held if np.linalg.norm(place) > 0.05 * size]
    lever = np.asarray(skeleton.leg.model.inertias[body].lever)
    beyond = 2.0 * lever if np.linalg.norm(lever) > 0.02 * size else np.array([0.0, 0.0, -0.25 * size])
    drawn = [hub]
    for end in (*(joints or [beyond]), *skeleton.loop_points(body)):
        bar = box((0.09 * size, 0.055 * size, float(np.linalg.norm(end))), BAR)
        drawn.append(bar.placed(homogeneous(0.5 * end, align_z(end, axis))))
    return drawn
