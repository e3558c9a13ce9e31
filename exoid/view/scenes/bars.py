"""Shapes for bodies that a URDF gives none: bars, joint housings, a foot, a belt, from the leg's own geometry."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .parts import Look, Part, box, cylinder, moved, ring, towards
from .skeleton import Skeleton

BAR, FRAME, SOLE = Look("#b3b8bf"), Look("#4a4e55"), Look("#1c1d20")

FEET = ("foot", "ankle", "toe", "sole")
"""Words in the name of a link or joint that make the last body a foot."""


def bars(skeleton: Skeleton, body: int, colour: str) -> list[Part]:
    """Shape a body that a joint carries: its housing, and bars to the next joints or through its centre of mass.

    Args:
        skeleton: Of the leg.
        body: Which, from 1 on.
        colour: Of the joint.
    """
    leg, size = skeleton.leg, _size(skeleton)
    axis = skeleton.axes[body - 1]
    along = towards(axis)
    parts = [
        cylinder(0.115 * size, 0.13 * size, FRAME).at(moved(np.zeros(3), along)),
        cylinder(0.075 * size, 0.145 * size, Look(colour)).at(moved(np.zeros(3), along)),
    ]
    ends = [
        place[:3, 3]
        for parent, place in zip(skeleton.parents, skeleton.placements, strict=True)
        if parent == body and np.linalg.norm(place[:3, 3]) > 0.05 * size
    ]
    names = (leg.joint_names[body - 1] + leg.link_names[body - 1]).lower()
    down = _down(skeleton, body)
    if not ends and any(word in names for word in FEET):
        return [*parts, *_foot(skeleton, axis, down, size)]
    if not ends:
        lever = np.asarray(leg.model.inertias[body].lever)
        end = 2.0 * lever if np.linalg.norm(lever) > 0.02 * size else 0.25 * size * down
        return [*parts, *_bar(end, axis, size), cylinder(0.07 * size, 0.1 * size, SOLE).at(moved(end, along))]
    for end in ends:
        parts += _bar(end, axis, size)
        if skeleton.leg.chain is not None:
            parts += _brace(end, axis, size)
    return parts


def mount(skeleton: Skeleton) -> list[Part]:
    """Shape what a leg hangs on: a belt with a back plate for a planar leg that hangs, else a foot for a robot arm."""
    hip, size = skeleton.placements[0][:3, 3], _size(skeleton)
    chain = skeleton.leg.chain
    if chain is None or _down(skeleton, 0) @ skeleton.leg.model.gravity.linear < 0.0:
        axis = skeleton.placements[0][:3, :3] @ skeleton.axes[0]
        return [cylinder(0.16 * size, 0.1 * size, FRAME).at(moved(hip, towards(axis)))]
    forward, lateral, up = chain.plane
    width = max(abs(float(hip @ lateral)), 0.35 * size)
    middle = hip - (hip @ lateral) * lateral if abs(float(hip @ lateral)) > 0.05 * size else hip - width * lateral
    frame = np.column_stack([forward, lateral, up])
    belt = ring(0.9 * width, 0.045 * size, 2.0 * np.pi, FRAME).at(moved(middle + 0.1 * size * up, frame))
    plate = box((0.06 * size, 1.3 * width, 1.1 * size), BAR).at(
        moved(middle - 0.9 * width * forward + 0.6 * size * up, frame)
    )
    arm = hip - middle
    strut = box((0.08 * size, float(np.linalg.norm(arm)), 0.08 * size), FRAME).at(
        moved(middle + 0.95 * arm + 0.05 * size * up - 0.5 * arm, frame)
    )
    return [belt, plate] if np.linalg.norm(arm) < 1.05 * width else [belt, plate, strut]


def _bar(end: FloatArray, axis: FloatArray, size: float) -> list[Part]:
    length = float(np.linalg.norm(end))
    return [box((0.09 * size, 0.055 * size, length), BAR).at(moved(0.5 * end, towards(end, axis)))]


def _brace(end: FloatArray, axis: FloatArray, size: float) -> list[Part]:
    """Half a ring behind the bar, where a strap holds the limb."""
    frame = towards(end, axis)
    backward = frame[:, 0]
    turned = np.column_stack([-frame[:, 1], frame[:, 0], frame[:, 2]]) if backward[0] < 0.0 else frame
    return [ring(0.17 * size, 0.022 * size, np.pi, SOLE).at(moved(0.45 * end, turned))]


def _foot(skeleton: Skeleton, axis: FloatArray, down: FloatArray, size: float) -> list[Part]:
    forward = np.cross(axis, -down)
    lever = np.asarray(skeleton.leg.model.inertias[skeleton.leg.model.njoints - 1].lever)
    forward = -forward if forward @ lever < 0.0 else forward
    frame = np.column_stack([forward, np.cross(-down, forward), -down])
    height = 0.24 * size
    return [
        box((0.1 * size, 0.05 * size, height), FRAME).at(moved(0.5 * height * down, frame)),
        box((0.6 * size, 0.22 * size, 0.04 * size), SOLE).at(moved(height * down + 0.14 * size * forward, frame)),
    ]


def _down(skeleton: Skeleton, body: int) -> FloatArray:
    """Direction of gravity in a body's frame with all joints at zero."""
    place = skeleton.bodies(np.zeros(len(skeleton.parents)))[0, body]
    gravity = place[:3, :3].T @ skeleton.leg.model.gravity.linear
    return np.asarray(gravity / max(float(np.linalg.norm(gravity)), 1e-9))


def _size(skeleton: Skeleton) -> float:
    """A typical length of a segment [m]."""
    lengths = [float(np.linalg.norm(place[:3, 3])) for place in skeleton.placements[1:]]
    longest = max(lengths, default=0.0)
    return longest if longest > 0.1 * skeleton.reach else skeleton.reach
