"""Drives as tables of plain values, as TOML and JSON files hold them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from exoid.errors import NotSupportedError, UnreadableInputError, nearest, within
from exoid.leg.leg import Leg
from exoid.tools.numbers import checked, is_number

from .actuators import Actuators
from .arm_table import MomentArmTable
from .attachments import Attachment, Attachments
from .coupling import Coupling
from .drive import Drive
from .linear import LinearActuator
from .motor import Motor
from .series_elastic import SeriesElastic

Table = Mapping[str, Any]

UNKNOWN = "unknown"
"""Word for a constant that is identified."""

KINDS = {"motor": Motor, "linear": LinearActuator, "series-elastic": SeriesElastic, "coupling": Coupling}
"""Class of each type of drive."""

REQUIRED = {
    Motor: {"torque_constant": f'write it in N·m/A, or torque_constant = "{UNKNOWN}"'},
    SeriesElastic: {"stiffness": "write that of the spring in N·m/rad"},
    Coupling: dict.fromkeys(("joints", "matrix"), "write joints = […] and matrix = [[…], […]]: q = A θ_m"),
    Attachments: dict.fromkeys(("first", "second"), 'write { link = "thigh", point = [x, y, z] } in m'),
}
"""Keys that a table must have, each with what to write."""


def actuators_from_data(data: Table, leg: Leg) -> Actuators:
    """Mount the drives of a file on a leg; drives of the robot's other joints are left out."""
    if not isinstance(data, Mapping) or not data:
        raise UnreadableInputError(
            "there are no drives", remedy='write a table for each joint: [left_hip] type = "motor" …'
        )
    drives: dict[str, Drive | Coupling] = {}
    for name, table in data.items():
        with within(f"[{name}]"):
            drives[name] = _drive(table)
    return Actuators.of(leg, drives)


def actuators_to_data(actuators: Actuators) -> dict[str, Any]:
    """Turn actuators into what files hold: a table for each joint and each coupling, by its name."""
    every: dict[str, Drive | Coupling] = {**actuators.drives, **actuators.couplings}
    return {name: _table(drive) for name, drive in every.items()}


def describe_actuators(actuators: Actuators) -> list[str]:
    """Describe each drive and each coupling in a line: its type and constants."""
    lines = []
    for name, table in actuators_to_data(actuators).items():
        parts = [str(table["type"])] if "type" in table else []
        for key, value in table.items():
            words = key.replace("_", " ")
            if key in ("first", "second"):
                parts.append(f"{value['link']} at ({', '.join(f'{x:g}' for x in value['point'])}) m")
            elif key in ("angle", "moment_arm"):
                parts.append(f"{words} {min(value):.4g} … {max(value):.4g} {'rad' if key == 'angle' else 'm'}")
            elif key != "type":
                parts.append(f"{words} {value:.6g}" if is_number(value) else f"{key} {value}")
        lines.append(f"{name}: {', '.join(parts)}")
    return lines


def _drive(table: object) -> Drive | Coupling:
    """Make a drive of its table."""
    if not isinstance(table, Mapping):
        raise UnreadableInputError(
            f"is {table!r}, not a table", remedy='write [left_hip] and below it type = "motor" …'
        )
    kind = KINDS.get(str(table.get("type")))
    if kind is None:
        what = f"type is {table['type']!r}" if "type" in table else "no type of drive"
        raise UnreadableInputError(what, remedy=f"write one of {', '.join(KINDS)}")
    constants = {key: value for key, value in table.items() if key != "type"}
    if kind is LinearActuator:
        return _linear(constants)
    _check_keys(constants, {field.name for field in fields(kind)}, REQUIRED[kind])
    can_be_unknown = {each.field for each in getattr(kind, "constants", ())}
    unknown = [key for key, value in constants.items() if key in can_be_unknown and value == UNKNOWN]
    drive: Drive | Coupling = kind(**{**constants, **dict.fromkeys(unknown)})
    return drive


def _check_keys(table: Table, known: set[str], required: Mapping[str, str]) -> None:
    for key in table:
        if key not in known:
            remedy = f"{nearest(key, known)}keys are {', '.join(sorted(known))}"
            raise UnreadableInputError(f"unknown key {key!r}", remedy=remedy)
    for key, remedy in required.items():
        if key not in table:
            raise UnreadableInputError(f"no {key}", remedy=remedy)


def _linear(table: Table) -> LinearActuator:
    points, arms = {"first", "second"}, {"angle", "angle_deg", "moment_arm"}
    needed = REQUIRED[Attachments] if points & table.keys() else {}
    _check_keys(table, points | arms | {"max_force", "gain"}, needed)
    if bool(points & table.keys()) == bool(arms & table.keys()):
        both = bool(points & table.keys())
        raise UnreadableInputError(
            "both attachment points and a table of moment arms" if both else "no attachment points",
            remedy="write first and second, or angle (or angle_deg) and moment_arm",
        )
    gain = table.get("gain", 1.0)
    limits = table.get("max_force"), None if gain == UNKNOWN else gain
    if not points & table.keys():
        return LinearActuator(_moment_arms(table), *limits)
    for key, remedy in needed.items():
        if not isinstance(table[key], Mapping) or set(table[key]) != {"link", "point"}:
            raise UnreadableInputError(f"{key} is {table[key]!r}", remedy=remedy)
    first, second = (Attachment(table[key]["link"], table[key]["point"]) for key in ("first", "second"))
    return LinearActuator(Attachments(first, second), *limits)


def _moment_arms(table: Table) -> MomentArmTable:
    angles = [key for key in ("angle", "angle_deg") if key in table]
    if len(angles) != 1 or "moment_arm" not in table:
        raise UnreadableInputError(
            "a table of moment arms needs its angles and arms", remedy="write angle (or angle_deg) and moment_arm [m]"
        )
    angle, arm = (checked(table[key], key) for key in (*angles, "moment_arm"))
    return MomentArmTable(np.deg2rad(angle) if angles[0] == "angle_deg" else angle, arm)


def _table(drive: Drive | Coupling) -> dict[str, Any]:
    """Table of a drive."""
    kind = next((name for name, each in KINDS.items() if type(drive) is each), None)
    if isinstance(drive, Motor | SeriesElastic):
        found = {field.name: getattr(drive, field.name) for field in fields(drive)}
        numbers = {name: float(value) for name, value in found.items() if value is not None}
        return {"type": kind, **{each.field: UNKNOWN for each in drive.unknown}, **numbers}
    if isinstance(drive, Coupling):
        return {"type": kind, "joints": [*drive.joints], "matrix": [[*row] for row in drive.matrix]}
    if isinstance(drive, LinearActuator):
        arm = drive.moment_arm
        limit: dict[str, Any] = {} if drive.max_force is None else {"max_force": float(drive.max_force)}
        limit |= {} if drive.gain == 1.0 else {"gain": UNKNOWN if drive.gain is None else float(drive.gain)}
        if isinstance(arm, MomentArmTable):
            return {"type": kind, "angle": [*arm.angle], "moment_arm": [*arm.moment_arm], **limit}
        if isinstance(arm, Attachments):
            ends = {"first": arm.first, "second": arm.second}
            return {
                "type": kind,
                **{key: {"link": end.link, "point": [*end.point]} for key, end in ends.items()},
                **limit,
            }
    raise NotSupportedError(f"{drive!r} has no form in a file", remedy="use the drives of exoid.actuators")
