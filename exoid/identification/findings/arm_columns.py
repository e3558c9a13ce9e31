"""Nuisance columns of moment arms: how the torque would change if an attachment point of a cylinder were elsewhere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators, Attachment, LinearActuator, MomentArmTable, MountedAttachments
from exoid.leg.leg import Leg

STEP = 1e-5
"""Step of finite differences [m]."""

SMALLEST_ARM = 1e-3
"""Moment arm below which a sample says nothing of the arm [m]."""


class ArmColumns(Protocol):
    """Two ways in which a moment arm may be wrong."""

    @property
    def unit(self) -> str:
        """Unit of their sizes."""

    @property
    def what(self) -> str:
        """Part of the actuator that would be wrong."""

    def shapes(self, q: FloatArray) -> FloatArray:
        """Compute the relative change of the arm by each."""


@dataclass(frozen=True)
class PointColumns:
    """Displacements of an attachment point in the plane of motion."""

    arm: MountedAttachments  # moment arm of the points as they are described
    # moment arms with the point displaced by `STEP` in two directions
    displaced: tuple[MountedAttachments, MountedAttachments]
    link: str  # link of the point

    unit = "m"

    @property
    def what(self) -> str:
        """Name of the point."""
        return f"attachment point on {self.link}"

    def shapes(self, q: FloatArray) -> FloatArray:
        """Compute the relative change of the arm by a displacement in each direction."""
        arm = self.arm.arm(q)
        known = np.abs(arm) > SMALLEST_ARM
        changes = [(displaced.arm(q) - arm) / STEP for displaced in self.displaced]
        return np.array([np.divide(change, arm, out=np.zeros_like(arm), where=known) for change in changes])


@dataclass(frozen=True)
class TableColumns:
    """Relative errors of a table that grow with the angle, and with its square."""

    middle: float  # middle of the table [rad]
    half: float  # half of its range [rad]

    unit = "1"
    what = "table of moment arms"

    def shapes(self, q: FloatArray) -> FloatArray:
        """Compute the relative change of the arm by each."""
        x = (q - self.middle) / self.half
        return np.array([x, x * x])


def arm_columns(actuators: Actuators | None, leg: Leg) -> dict[int, ArmColumns]:
    """Find what may be wrong about the moment arms of linear actuators."""
    return {} if actuators is None else dict(_columns(actuators, leg))


def _columns(actuators: Actuators, leg: Leg) -> Iterator[tuple[int, ArmColumns]]:
    for joint, drive in actuators.drives.items():
        if not isinstance(drive, LinearActuator):
            continue
        place, arm = leg.joint_names.index(joint), drive.moment_arm
        if isinstance(arm, MomentArmTable):
            low, high = arm.angle[0], arm.angle[-1]
            yield place, TableColumns(0.5 * (low + high), 0.5 * (high - low))
        elif isinstance(arm, MountedAttachments):
            yield place, _of_points(arm, leg, joint)


def _of_points(arm: MountedAttachments, leg: Leg, joint: str) -> PointColumns:
    """Displace the point whose displacement changes the arm most: the one nearer to the joint."""
    points = arm.attachments
    q = np.linspace(-1.0, 1.0, 9)
    best: tuple[float, PointColumns] | None = None
    for name in ("first", "second"):
        end: Attachment = getattr(points, name)
        moved = []
        for axis in np.eye(3):
            point = np.add(end.point, STEP * axis).tolist()
            changes: Mapping[str, Attachment] = {name: Attachment(end.link, (point[0], point[1], point[2]))}
            moved.append(replace(points, **changes).on(leg, joint))
        sizes = [float(np.linalg.norm(each.arm(q) - arm.arm(q))) for each in moved]
        first, second = np.argsort(sizes)[:0:-1]  # the axis of the joint changes the arm least
        found = PointColumns(arm, (moved[int(first)], moved[int(second)]), end.link)
        if best is None or max(sizes) > best[0]:
            best = max(sizes), found
    assert best is not None
    return best[1]
