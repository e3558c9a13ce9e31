"""Quantities of the joints that a recording can have."""

from __future__ import annotations

UNITS = {
    "q": "rad",
    "v": "rad/s",
    "a": "rad/s²",
    "tau": "N·m",
    "current": "A",
    "force": "N",
    "motor_torque": "N·m",
    "motor_angle": "rad",
    "temperature": "°C",
}
"""Unit of each quantity of a joint."""

OF_SOME_JOINTS = ("tau", "current", "force", "motor_torque", "motor_angle", "temperature")
"""Quantities that need not be measured at all joints: their other columns are NaN throughout."""

USUAL = ("q", "v", "a", "tau")
"""Quantities that a table of a recording shows even if they were not recorded."""

PREFIXES = {"current": "i", "force": "f", "motor_torque": "tm", "motor_angle": "qm", "temperature": "temp"}
"""Beginning of the column names of each quantity whose name differs."""
