"""Arrows: straight ones for weights, round ones about the axis of a joint for torques."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .parts import Look, Part, cylinder, moved, ring, towards

WEIGHT = "#7a3b9a"
"""Colour of weights."""

ARC = np.deg2rad(250.0)
"""How far a round arrow goes round."""

LEAST = 1e-3
"""Scale of an arrow for nothing: a scale of 0 has no inverse."""


def straight(length: float, thickness: float, colour: str) -> list[Part]:
    """Draw an arrow of a length [m] along z, from the origin."""
    look, head = Look(colour, finish="flat"), min(5.0 * thickness, 0.5 * length)
    return [
        cylinder(0.5 * thickness, length - head, look).at(moved((0.0, 0.0, 0.5 * (length - head)))),
        cylinder(1.5 * thickness, head, look, tip=0.0).at(moved((0.0, 0.0, length - 0.5 * head))),
    ]


def around(radius: float, thickness: float, colour: str) -> list[Part]:
    """Draw an arrow of a radius [m] around z, counter-clockwise, its gap opposite to x."""
    look, head = Look(colour, finish="flat"), 5.5 * thickness
    tangent = towards((-np.sin(0.5 * ARC), np.cos(0.5 * ARC), 0.0), (0.0, 0.0, 1.0))
    tip = np.array([np.cos(0.5 * ARC), np.sin(0.5 * ARC), 0.0]) * radius + 0.45 * head * tangent[:, 2]
    turned = moved(np.zeros(3), _about_z(-0.5 * ARC))
    return [
        ring(radius, 0.5 * thickness, ARC, look).at(turned),
        cylinder(1.6 * thickness, head, look, tip=0.0).at(moved(tip, tangent)),
    ]


def torque_scale(torque: FloatArray, largest: float) -> FloatArray:
    """Scale of the round arrow for each torque, (N, 3): its area is the torque, and it turns round with the sign.

    Args:
        torque: [N·m], (N,).
        largest: Torque whose arrow has the scale 1 [N·m].
    """
    size = np.sqrt(np.abs(torque) / largest) if largest > 0.0 else np.zeros_like(torque)
    size = np.maximum(size, LEAST)
    return np.column_stack([size, np.where(torque < 0.0, -size, size), size])


def _about_z(angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
