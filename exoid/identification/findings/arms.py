"""Moment arms that may be wrong: how the torque would change if an attachment point of a cylinder were elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators, Attachment, Attachments, LinearActuator, MomentArmTable
from exoid.leg.leg import Leg


class ArmShapes(NamedTuple):
    """Two ways in which a moment arm may be wrong."""

    unit: str  # unit of their sizes
    what: str  # part of the actuator that would be wrong
    shapes: Callable[[FloatArray], FloatArray]  # relative change of the arm by each, over the angle, (2, N)


def arm_shapes(actuators: Actuators, leg: Leg) -> dict[int, ArmShapes]:
    """Find what may be wrong about the moment arms of linear actuators, by the index of their joint."""
    found = {}
    for joint, drive in actuators.drives.items():
        if isinstance(drive, LinearActuator):
            arm, place = drive.moment_arm, leg.joint_names.index(joint)
            if isinstance(arm, MomentArmTable):
                found[place] = _of_table(arm)
            elif isinstance(arm, Attachments):
                found[place] = _of_points(arm, leg, joint)
    return found


def _of_table(arm: MomentArmTable) -> ArmShapes:
    """Relative errors of a table that grow with the angle, and with its square."""
    middle, half = 0.5 * (arm.angle[0] + arm.angle[-1]), 0.5 * (arm.angle[-1] - arm.angle[0])
    return ArmShapes("1", "table of moment arms", lambda q: ((q - middle) / half) ** np.array([[1], [2]]))


def _of_points(arm: Attachments, leg: Leg, joint: str) -> ArmShapes:
    """Displacements, in the plane of motion, of the point that changes the arm most: the one nearer to the joint."""
    step = 1e-5  # [m], of finite differences
    q = np.linspace(-1.0, 1.0, 9)
    best, link, displaced = -1.0, "", []
    for name in ("first", "second"):
        end: Attachment = getattr(arm, name)
        moved = []
        for axis in np.eye(3):
            x, y, z = np.add(end.point, step * axis).tolist()
            change: dict[str, Any] = {name: Attachment(end.link, (x, y, z))}
            moved.append(replace(arm, **change).on(leg, joint))
        sizes = [float(np.linalg.norm(each.arm(q) - arm.arm(q))) for each in moved]
        if max(sizes) > best:
            first, second = np.argsort(sizes)[:0:-1]  # the axis of the joint changes the arm least
            best, link, displaced = max(sizes), end.link, [moved[int(first)], moved[int(second)]]

    def shapes(q: FloatArray) -> FloatArray:
        size = arm.arm(q)
        known = np.abs(size) > 1e-3  # a sample with a shorter arm [m] says nothing of the arm
        changes = [(each.arm(q) - size) / step for each in displaced]
        return np.array([np.divide(change, size, out=np.zeros_like(size), where=known) for change in changes])

    return ArmShapes("m", f"attachment point on {link}", shapes)
