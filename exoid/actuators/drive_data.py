"""Drives as tables of plain values, as TOML and JSON files hold them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from difflib import get_close_matches
from typing import Any

import numpy as np

from exoid.errors import ExoidError
from exoid.leg.leg import Leg

from .actuators import Actuators
from .arm_table import MomentArmTable
from .attachments import Attachment, Attachments, MountedAttachments
from .coupling import Coupling
from .drive import Drive, is_number
from .linear import LinearActuator
from .motor import Motor
from .places import within
from .series_elastic import SeriesElastic
from .transmission import Transmission, read_transmissions

TYPE = "type"
"""Key of the type of a drive."""

UNKNOWN = "unknown"
"""Word for a constant that is identified."""

CAN_BE_UNKNOWN = ("torque_constant", "efficiency")
"""Constants of a motor that it may stand for."""

Table = Mapping[str, Any]


def actuators_from_data(data: Table, leg: Leg, *, transmissions: bool = True) -> Actuators:
    """Mount the drives of a file on a leg; drives of the robot's other joints are left out.

    Ratio and efficiency of a motor that the file does not give are those of the ``<transmission>`` in the URDF.

    Args:
        data: A table for each joint, and for each coupling, by its name.
        leg: The leg.
        transmissions: Whether to look at the ``<transmission>`` elements of the URDF.

    Returns:
        The actuators.

    Raises:
        ExoidError: A table has a wrong key or value, or a drive does not fit the leg: names table and key.
    """
    if not isinstance(data, Mapping) or not data:
        raise ExoidError("there are no drives", remedy='write a table for each joint: [left_hip] type = "motor" …')
    drives: dict[str, Drive | Coupling] = {}
    gears = read_transmissions(leg.description) if transmissions else {}
    gears |= {label: gears[n] for label, n in zip(leg.joint_labels, leg.joint_names, strict=True) if n in gears}
    for name, table in data.items():
        with within(f"[{name}]"):
            drives[name] = _drive(_with_transmission(table, gears.get(name)))
    return Actuators.of(leg, drives)


def actuators_to_data(actuators: Actuators) -> dict[str, Any]:
    """Turn actuators into what files hold.

    Args:
        actuators: The actuators.

    Returns:
        A table for each joint and each coupling, of which :func:`actuators_from_data` makes the same actuators.

    Raises:
        ExoidError: A drive is not of exoid, so that no file can hold it.
    """
    every: dict[str, Drive | Coupling] = {**actuators.drives, **actuators.couplings}
    return {name: _table(drive) for name, drive in every.items()}


def describe_actuators(actuators: Actuators) -> list[str]:
    """Describe each drive in a line.

    Args:
        actuators: The actuators.

    Returns:
        A line for each joint with a drive, and for each coupling: its type and constants.
    """
    return [f"{name}: {_written(table)}" for name, table in actuators_to_data(actuators).items()]


def _written(table: Table) -> str:
    """Write type and constants of a drive."""
    parts = [str(table[TYPE])]
    for key, value in table.items():
        if key in ("first", "second"):
            parts.append(f"{value['link']} at ({', '.join(f'{x:g}' for x in value['point'])}) m")
        elif key in ("angle", "moment_arm"):
            unit = "rad" if key == "angle" else "m"
            parts.append(f"{key.replace('_', ' ')} {min(value):.4g} … {max(value):.4g} {unit}")
        elif key == "motors":
            parts += [f"motor {_written({TYPE: '', **motor})}".replace(" ,", "") for motor in value]
        elif key != TYPE:
            parts.append(f"{key.replace('_', ' ')} {value:.6g}" if is_number(value) else f"{key} {value}")
    return ", ".join(parts)


def _drive(table: object) -> Drive | Coupling:
    """Make a drive of its table."""
    if not isinstance(table, Mapping):
        raise ExoidError(f"is {table!r}, not a table", remedy='write [left_hip] and below it type = "motor" …')
    kind = str(table.get(TYPE))
    if kind not in READERS:
        raise ExoidError(
            f"type is {kind!r}" if TYPE in table else "no type of drive", remedy=f"write one of {', '.join(READERS)}"
        )
    return READERS[kind]({key: value for key, value in table.items() if key != TYPE})


def _with_transmission(table: object, gear: Transmission | None) -> object:
    """Take ratio and efficiency of a motor from the URDF, where its table has none."""
    if gear is None or not isinstance(table, Mapping) or table.get(TYPE) != "motor":
        return table
    given = {"ratio": gear.ratio, "efficiency": gear.efficiency}
    for key, value in given.items():
        if key in table and value is not None and table[key] != value:
            raise ExoidError(
                f"{key} is {table[key]!r}, and <transmission> of the URDF says {value:g}",
                remedy="correct one of them, or leave it out here",
            )
    return {**{key: value for key, value in given.items() if value is not None}, **table}


def _motor(table: Table) -> Motor:
    if "torque_constant" not in table:
        raise ExoidError("no torque_constant", remedy='write it in N·m/A, or torque_constant = "unknown"')
    known = {field.name for field in fields(Motor)}
    _refuse_other_keys(table, known)
    unknown = [key for key in CAN_BE_UNKNOWN if table.get(key) == UNKNOWN]
    return Motor(**{**table, **dict.fromkeys(unknown)})


def _linear(table: Table) -> LinearActuator:
    points, arms = {"first", "second"}, {"angle", "angle_deg", "moment_arm"}
    _refuse_other_keys(table, points | arms | {"max_force", "gain"})
    has_points, has_arms = bool(points & table.keys()), bool(arms & table.keys())
    if has_points == has_arms:
        what = "both attachment points and a table of moment arms" if has_points else "no attachment points"
        raise ExoidError(what, remedy="write first and second, or angle (or angle_deg) and moment_arm")
    arm = _attachments(table) if has_points else _moment_arms(table)
    gain = table.get("gain", 1.0)
    return LinearActuator(arm, table.get("max_force"), None if gain == UNKNOWN else gain)


def _attachments(table: Table) -> Attachments:
    missing = [key for key in ("first", "second") if key not in table]
    if missing:
        raise ExoidError(f"no {missing[0]}", remedy='write { link = "thigh", point = [x, y, z] } in m')
    ends = []
    for key in ("first", "second"):
        given = table[key]
        if not isinstance(given, Mapping) or set(given) != {"link", "point"}:
            raise ExoidError(f"{key} is {given!r}", remedy='write { link = "thigh", point = [x, y, z] } in m')
        ends.append(Attachment(given["link"], given["point"]))
    return Attachments(*ends)


def _moment_arms(table: Table) -> MomentArmTable:
    angles = [key for key in ("angle", "angle_deg") if key in table]
    if len(angles) != 1 or "moment_arm" not in table:
        raise ExoidError(
            "a table of moment arms needs its angles and arms", remedy="write angle (or angle_deg) and moment_arm [m]"
        )
    for key in (*angles, "moment_arm"):
        row = table[key]
        if not isinstance(row, Sequence) or isinstance(row, str) or not all(is_number(value) for value in row):
            raise ExoidError(f"{key} is no row of numbers", remedy="write [0.0, 0.1, …]")
    angle = table[angles[0]]
    return MomentArmTable(np.deg2rad(angle).tolist() if angles[0] == "angle_deg" else angle, table["moment_arm"])


def _series_elastic(table: Table) -> SeriesElastic:
    _refuse_other_keys(table, {"stiffness", "ratio"})
    if "stiffness" not in table:
        raise ExoidError("no stiffness", remedy="write that of the spring in N·m/rad")
    return SeriesElastic(**table)


def _coupling(table: Table) -> Coupling:
    _refuse_other_keys(table, {"joints", "matrix", "motors"})
    missing = [key for key in ("joints", "matrix") if key not in table]
    if missing:
        raise ExoidError(f"no {missing[0]}", remedy="write joints = […] and matrix = [[…], […]]: q = A θ_m")
    joints, motors = table["joints"], table.get("motors", [])
    if not isinstance(joints, list | tuple) or not isinstance(motors, list | tuple):
        raise ExoidError("joints or motors of a coupling are no row", remedy='write joints = ["roll", "pitch"]')
    if not all(isinstance(motor, Mapping) for motor in motors):
        raise ExoidError("a motor of the coupling is no table", remedy="write motors = [{ torque_constant = 0.1 }, …]")
    return Coupling(tuple(joints), table["matrix"], tuple(_motor(motor) for motor in motors))


READERS: Mapping[str, Callable[[Table], Drive | Coupling]] = {
    "motor": _motor,
    "linear": _linear,
    "series-elastic": _series_elastic,
    "coupling": _coupling,
}
"""Function that reads each type of drive."""


def _refuse_other_keys(table: Table, known: set[str]) -> None:
    for key in table:
        if key not in known:
            close = get_close_matches(key, known, n=1)
            hint = f"did you mean {close[0]}? " if close else ""
            raise ExoidError(f"unknown key {key!r}", remedy=f"{hint}keys are {', '.join(sorted(known))}")


def _table(drive: Drive | Coupling) -> dict[str, Any]:
    """Table of a drive."""
    if isinstance(drive, Motor):
        return {TYPE: "motor", **_settings(drive)}
    if isinstance(drive, SeriesElastic):
        return {TYPE: "series-elastic", **_settings(drive)}
    if isinstance(drive, Coupling):
        motors = {"motors": [_settings(motor) for motor in drive.motors]} if drive.motors else {}
        return {TYPE: "coupling", "joints": [*drive.joints], "matrix": [[*row] for row in drive.matrix], **motors}
    if isinstance(drive, LinearActuator):
        arm = drive.moment_arm
        limit: dict[str, Any] = {} if drive.max_force is None else {"max_force": float(drive.max_force)}
        limit |= {} if drive.gain == 1.0 else {"gain": UNKNOWN if drive.gain is None else float(drive.gain)}
        if isinstance(arm, MomentArmTable):
            return {TYPE: "linear", "angle": [*arm.angle], "moment_arm": [*arm.moment_arm], **limit}
        points = arm.attachments if isinstance(arm, MountedAttachments) else arm
        if isinstance(points, Attachments):
            ends = {key: getattr(points, key) for key in ("first", "second")}
            return {
                TYPE: "linear",
                **{key: {"link": end.link, "point": [*end.point]} for key, end in ends.items()},
                **limit,
            }
    raise ExoidError(f"{drive!r} has no form in a file", remedy="use the drives of exoid.actuators")


def _settings(drive: Motor | SeriesElastic) -> dict[str, Any]:
    """Settings that are not None; an unknown constant of a motor is a word."""
    found = {field.name: getattr(drive, field.name) for field in fields(drive)}
    numbers = {name: float(value) for name, value in found.items() if value is not None}
    unknown = [key for key in CAN_BE_UNKNOWN if isinstance(drive, Motor) and found[key] is None]
    return {**dict.fromkeys(unknown, UNKNOWN), **numbers}
