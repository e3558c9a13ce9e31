"""Units of positions: degrees, and millimetres of joints that slide."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid.leg.leg import Leg

from .catalog import turning_joints


class PositionUnit(NamedTuple):
    """Unit in which positions of a joint are given and shown: degrees, or millimetres of a prismatic joint."""

    size: float  # how large it is [rad or m]
    name: str  # as it follows a number

    @property
    def axes(self) -> dict[str, str]:
        """Quantities of the joint with their units, as axes of figures name them."""
        if self.name == "°":
            return {"angle": "angle [deg]", "velocity": "velocity [rad/s]", "torque": "torque [N·m]"}
        return {"angle": "position [mm]", "velocity": "velocity [m/s]", "torque": "force [N]"}

    def show(self, position: float) -> str:
        """Write a position."""
        return f"{position / self.size:.1f}{self.name}"


def position_units(leg: Leg) -> tuple[PositionUnit, ...]:
    """Unit of each joint, n of them."""
    each = (PositionUnit(np.deg2rad(1.0), "°") if turns else PositionUnit(1e-3, " mm") for turns in turning_joints(leg))
    return tuple(each)


def heading(units: Sequence[PositionUnit], quantity: str = "angle") -> str:
    """Unit of a column of positions, velocities or torques, "deg or mm" where some joints slide."""
    return " or ".join(dict.fromkeys(unit.axes[quantity].split("[")[1].rstrip("]") for unit in units))
