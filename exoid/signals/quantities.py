"""Quantities of the joints that a recording can have, and the units that columns of logs may have."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import NamedTuple

from exoid.errors import UnreadableInputError


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
)

UNITS = {quantity.field: quantity.unit for quantity in QUANTITIES}
PREFIXES = {quantity.field: quantity.prefix for quantity in QUANTITIES}

USUAL = ("q", "v", "a", "tau")
"""Quantities that a table of a recording shows even if they were not recorded."""

_ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0, "°": math.pi / 180.0, "rev": 2.0 * math.pi}
_TORQUES = {"N·m": 1.0, "mN·m": 1e-3, "N·mm": 1e-3, "N·cm": 1e-2, "kN·m": 1e3}
_FORCES = {"N": 1.0, "mN": 1e-3, "kN": 1e3}
_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}

FACTORS: Mapping[str, tuple[str, Mapping[str, float]]] = {
    "time": ("time", {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0}),
    "q": ("angle", _ANGLES),
    "v": ("velocity", {**{f"{unit}/s": size for unit, size in _ANGLES.items()}, "rpm": math.pi / 30.0}),
    "a": ("acceleration", {f"{unit}/s²": size for unit, size in _ANGLES.items()}),
    "tau": ("torque", _TORQUES),
    "i": ("current", {"A": 1.0, "mA": 1e-3}),
    "f": ("force", _FORCES),
    "tm": ("motor torque", _TORQUES),
    "qm": ("motor angle", _ANGLES),
    "base_gyro": ("angular velocity of the base", {f"{unit}/s": size for unit, size in _ANGLES.items()}),
    "base_acc": ("specific force of the base", {"m/s²": 1.0, "mm/s²": 1e-3, "g": 9.80665, "mg": 9.80665e-3}),
    "base_q": ("a quaternion, which has none", {}),
    "base": ("position of the base", _LENGTHS),
    "wrench_f": ("force on a link", _FORCES),
    "wrench_m": ("moment on a link", _TORQUES),
    "wrench_p": ("point of a wrench", _LENGTHS),
    "contact": ("a contact, which has none", {}),
}
"""Word for a quantity, and factor to SI of each unit, by the part of a column's name before ``_<joint>``."""

BRACKETED = re.compile(r"[\[(]([^\])]+)[\])]\s*$")
"""Unit at the end of a header, such as ``hip torque [N·mm]``."""

CURRENT = re.compile(r"(?<![a-z])(current|curr|cur|amps?|amperes?)(?![a-z])", re.IGNORECASE)
"""Words for a motor current in a header."""


def spelled(unit: str) -> str:
    """Write a unit without the signs that people write differently: ``N.m``, ``Nm`` and ``N·m`` are one."""
    plain = unit.replace("²", "2").replace("μ", "µ").replace("µ", "u").replace("°", "deg")
    return re.sub(r"[\s·⋅.*^]", "", plain).replace("Ampere", "A")


def factor_of(unit: str, quantity: str) -> float | None:
    """Find the factor of a unit to SI."""
    known = {spelled(name): size for name, size in FACTORS[quantity][1].items()}
    return known.get(spelled(unit))


def is_unit(text: str) -> bool:
    """Tell whether a text is a unit of any quantity."""
    return any(factor_of(text, quantity) is not None for quantity in FACTORS)


def is_number(text: str) -> bool:
    """Tell whether a text is a number as logs write them, NaN and infinity too, without Python's underscores."""
    try:
        float(text)
    except ValueError:
        return False
    return text.isascii() and "_" not in text


def quantity_of(name: str) -> str:
    """Find the quantity of an exoid column."""
    if name.startswith("base_"):
        return next(kind for kind in ("base_gyro", "base_acc", "base_q", "base") if name.startswith(kind))
    if name.startswith("wrench_"):
        return f"wrench_{name.rpartition('_')[2][0]}"
    return name if name == "time" else name.partition("_")[0]


def refuse_other_unit(unit: str, name: str) -> float:
    """Find the factor of a column's unit, or refuse a unit that does not belong to its quantity."""
    quantity = quantity_of(name)
    factor = factor_of(unit, quantity)
    if factor is not None:
        return factor
    meaning, units = FACTORS[quantity]
    remedy = command = f"units of {meaning} are {', '.join(units)}"
    if quantity in ("tau", "f", "tm") and factor_of(unit, "i") is not None:
        joint, scale = name.partition("_")[2], "0.118"
        aim = "N" if quantity == "f" else "N·m"
        remedy = f'read it as current, columns={{"i_{joint}": ...}}, or give the scale in {aim} per A'
        command = f"read it as current (i_{joint}=HEADER:{unit}), or give {aim} per A: {name}=HEADER:{scale}"
    raise UnreadableInputError(f"{unit!r} is not a unit of {meaning} ({name})", remedy=remedy, command=command)


def refuse_silent_unit(header: str, name: str, *, degrees: bool) -> None:
    """Refuse a header that names a unit which the column is not read in, or a current that is read as torque."""
    quantity = quantity_of(name)
    written = BRACKETED.search(header)
    unit = written.group(1).strip() if written is not None else ""
    if unit and is_unit(unit):
        factor = factor_of(unit, quantity)
        in_degrees = quantity in ("q", "v", "a", "qm") and degrees
        expected = math.pi / 180.0 if in_degrees else 1.0
        if factor is None or not math.isclose(factor, expected):
            si = next(iter(FACTORS[quantity][1]), "1") if not in_degrees else "degrees"
            raise UnreadableInputError(
                f"column {header!r} says {unit}, and would be read as {name} in {si}",
                remedy=f'say its unit or its scale: columns={{"{name}": exoid.signals.Column({header!r}, unit=...)}}',
                command=f"say its unit or its scale: --column '{name}={header}:UNIT' or ':SCALE'",
            )
    elif quantity in ("tau", "f", "tm") and CURRENT.search(header):
        aim = "N" if quantity == "f" else "N·m"
        joint = name.partition("_")[2]
        raise UnreadableInputError(
            f"column {header!r} is to be {name} [{aim}], and its name says that it is a current",
            remedy=f'give Column({header!r}, scale=...) in {aim} per A, map it to "i_{joint}", or say unit="{aim}"',
            command=f"give {aim} per A ({name}={header}:0.118), map it to i_{joint}, or say its unit "
            f"({name}={header}:{aim})",
        )
