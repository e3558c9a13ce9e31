"""Arrows: straight ones for weights, circular ones around joint axes for torques."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .transforms import align_z, homogeneous
from .visual import Material, Visual, cylinder, torus

ARC = np.deg2rad(250.0)
"""Angle that a circular arrow spans [rad]."""

SMALLEST_SCALE = 1e-3
"""Scale of an arrow of zero torque: a scale of 0 has no inverse."""


def straight_arrow(length: float, thickness: float, colour: str) -> list[Visual]:
    """Make an arrow from the origin along z, of a length and a thickness [m]."""
    material, head = Material(colour, finish="flat"), min(5.0 * thickness, 0.5 * length)
    shaft = cylinder(0.5 * thickness, length - head, material)
    tip = cylinder(1.5 * thickness, head, material, top_radius=0.0)
    return [
        shaft.placed(homogeneous((0.0, 0.0, 0.5 * (length - head)))),
        tip.placed(homogeneous((0.0, 0.0, length - 0.5 * head))),
    ]


def circular_arrow(radius: float, thickness: float, colour: str) -> list[Visual]:
    """Make an arrow of a radius and a thickness [m] around z, counter-clockwise, with its gap at negative x."""
    material, head = Material(colour, finish="flat"), 5.5 * thickness
    c, s = np.cos(0.5 * ARC), np.sin(0.5 * ARC)
    tangent = align_z((-s, c, 0.0), (0.0, 0.0, 1.0))
    end = np.array([c, s, 0.0]) * radius + 0.45 * head * tangent[:, 2]
    backward = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])  # rotation by half the arc
    return [
        torus(radius, 0.5 * thickness, ARC, material).placed(homogeneous(np.zeros(3), backward)),
        cylinder(1.6 * thickness, head, material, top_radius=0.0).placed(homogeneous(end, tangent)),
    ]


def torque_scale(torque: FloatArray, largest: float) -> FloatArray:
    """Scale of the circular arrow for each torque: its area is proportional to the torque, its direction the sign."""
    size = np.sqrt(np.abs(torque) / largest) if largest > 0.0 else np.zeros_like(torque)
    size = np.maximum(size, SMALLEST_SCALE)
    return np.column_stack([size, np.where(torque < 0.0, -size, size), size])
