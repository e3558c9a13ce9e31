"""Shapes for bodies that a URDF gives none: bars, joint housings, a foot, a belt, from the leg's own geometry."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

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
    if not ends and any(word in names for word in FEET):
        return [*parts, *_foot(skeleton, body, size)]
    if not ends:
        lever = np.asarray(leg.model.inertias[body].lever)
        end = 2.0 * lever if np.linalg.norm(lever) > 0.02 * size else 0.25 * size * _down(skeleton, body)
        return [*parts, *_bar(end, axis, size), cylinder(0.07 * size, 0.1 * size, SOLE).at(moved(end, along))]
    for end in ends:
        parts += _bar(end, axis, size)
        if skeleton.leg.chain is not None:
            parts += _brace(end, axis, size)
    return parts


def mount(skeleton: Skeleton) -> list[Part]:
    """Shape what a leg hangs on: a belt with a back plate for a planar leg that hangs, else a socket."""
    hip, size = skeleton.placements[0][:3, 3], _size(skeleton)
    chain = skeleton.leg.chain
    if chain is None or not _hangs(skeleton):
        axis = skeleton.placements[0][:3, :3] @ skeleton.axes[0]
        return [cylinder(0.16 * size, 0.1 * size, FRAME).at(moved(hip, towards(axis)))]
    forward, lateral, up = chain.plane
    beside = float(hip @ lateral)  # of a leg in the middle, the body is drawn on one side
    width = max(abs(beside), 0.35 * size)
    middle = hip - (beside if abs(beside) > 0.05 * size else width) * lateral
    frame = np.column_stack([forward, lateral, up])
    belt = ring(0.9 * width, 0.045 * size, 2.0 * np.pi, FRAME).at(moved(middle + 0.1 * size * up, frame))
    behind = middle - 0.9 * width * forward + 0.6 * size * up
    return [belt, box((0.06 * size, 1.3 * width, 1.1 * size), BAR).at(moved(behind, frame))]


def _hangs(skeleton: Skeleton) -> bool:
    """Whether the centre of mass is below the first joint with all joints at zero."""
    model = skeleton.leg.model
    centre = pin.centerOfMass(model, model.createData(), pin.neutral(model))
    return bool((centre - skeleton.placements[0][:3, 3]) @ model.gravity.linear > 0.0)


def _bar(end: FloatArray, axis: FloatArray, size: float) -> list[Part]:
    length = float(np.linalg.norm(end))
    return [box((0.09 * size, 0.055 * size, length), BAR).at(moved(0.5 * end, towards(end, axis)))]


def _brace(end: FloatArray, axis: FloatArray, size: float) -> list[Part]:
    """Half a ring behind the bar, where a strap holds the limb."""
    frame = towards(end, axis)
    backward = frame[:, 0]
    turned = np.column_stack([-frame[:, 1], frame[:, 0], frame[:, 2]]) if backward[0] < 0.0 else frame
    return [ring(0.17 * size, 0.022 * size, np.pi, SOLE).at(moved(0.45 * end, turned))]


def _foot(skeleton: Skeleton, body: int, size: float) -> list[Part]:
    """Shape a sole below the joint that points forward: along x of the URDF, or to where the mass is."""
    down, chain = _down(skeleton, body), skeleton.leg.chain
    place = skeleton.bodies(np.zeros(len(skeleton.parents)))[0, body]
    forward = place[:3, :3].T @ (np.array([1.0, 0.0, 0.0]) if chain is None else chain.plane.forward)
    if forward @ skeleton.leg.model.inertias[body].lever < -0.02 * size:
        forward = -forward
    frame = towards(-down, np.cross(-down, forward))
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
