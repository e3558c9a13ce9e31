"""Quantities of the joints that a recording can have: field, column, unit, and how they are read and resampled."""

from __future__ import annotations

from typing import NamedTuple


class Quantity(NamedTuple):
    """A quantity of the joints."""

    field: str  # field of a recording
    prefix: str  # beginning of the names of its columns, `q_<joint>`
    unit: str
    partial: bool = True  # whether it need not be measured at all joints: other columns are NaN throughout
    angular: bool = False  # whether a log may give it in degrees
    smooth: bool = False  # whether it has no jumps, so that a cubic spline interpolates it
    of_drive: bool = True  # whether a matrix of this name may be of other things than joints


QUANTITIES = (
    Quantity("q", "q", "rad", partial=False, angular=True, smooth=True, of_drive=False),
    Quantity("v", "v", "rad/s", partial=False, angular=True, smooth=True, of_drive=False),
    Quantity("a", "a", "rad/s²", partial=False, angular=True, of_drive=False),
    Quantity("tau", "tau", "N·m", of_drive=False),
    Quantity("current", "i", "A"),
    Quantity("force", "f", "N"),
    Quantity("motor_torque", "tm", "N·m"),
    Quantity("motor_angle", "qm", "rad", angular=True, smooth=True),
    Quantity("temperature", "temp", "°C"),
)

UNITS = {quantity.field: quantity.unit for quantity in QUANTITIES}
PREFIXES = {quantity.field: quantity.prefix for quantity in QUANTITIES}

USUAL = ("q", "v", "a", "tau")
"""Quantities that a table of a recording shows even if they were not recorded."""
