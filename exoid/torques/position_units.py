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
    rad: str  # SI unit of positions
    torque: str  # unit of torques

    @property
    def axes(self) -> dict[str, str]:
        """Quantities of the joint with their units, as axes of figures name them."""
        position, torque = ("angle [deg]", "torque") if self.rad == "rad" else ("position [mm]", "force")
        return {"angle": position, "velocity": f"velocity [{self.rad}/s]", "torque": f"{torque} [{self.torque}]"}

    def show(self, position: float) -> str:
        """Write a position."""
        return f"{position / self.size:.1f}{self.name}"


TURNS, SLIDES = PositionUnit(np.deg2rad(1.0), "°", "rad", "N·m"), PositionUnit(1e-3, " mm", "m", "N")


def position_units(leg: Leg) -> tuple[PositionUnit, ...]:
    """Unit of each joint, n of them."""
    return tuple(TURNS if turns else SLIDES for turns in turning_joints(leg))


def heading(units: Sequence[PositionUnit], form: str = "{deg}") -> str:
    """Unit of a column of these joints, "N·m/s or N/s" where some slide and its form is "{torque}/s"."""
    names = (unit._asdict() | {"deg": unit.name.strip().replace("°", "deg")} for unit in units)
    return " or ".join(dict.fromkeys(form.format(**each) for each in names))
