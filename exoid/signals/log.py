"""Reading a log: finds time, angles, velocities, accelerations and torques among its columns, and checks them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError

from . import checks
from .formats import QUANTITIES, Table
from .source import Source
from .source_location import SourceLocation


class Log(NamedTuple):
    """Checked content of a log file in SI units.

    Attributes:
        time: Time stamps [s], (N,), strictly increasing.
        arrays: Arrays by quantity, (N, n) each: "q", and those of "v", "a" and "tau" that the file has.
        joint_names: Names of the n columns.
        source: File name and SHA-256.
        where: Location of the rows in the file.
    """

    time: FloatArray
    arrays: Mapping[str, FloatArray]
    joint_names: tuple[str, ...]
    source: Source
    where: SourceLocation


def read_log(
    table: Table,
    joint_names: Sequence[str] | None = None,
    columns: Mapping[str, str] | None = None,
    angle_unit: Literal["rad", "deg"] = "rad",
    largest_angle: float = checks.LARGEST_ANGLE,
) -> Log:
    """Take ``time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>`` from a table; see `Recording.from_file`.

    Args:
        table: Columns of the file.
        joint_names: Joints to read; None for those of the ``q_`` columns.
        columns: Header in the file of each exoid column whose name differs.
        angle_unit: Unit of angles in the file, for q, v and a.
        largest_angle: Limit of the angles [rad].

    Returns:
        The checked log.

    Raises:
        ExoidError: A check fails; names file, row and column.
    """
    if angle_unit not in ("rad", "deg"):
        raise ExoidError(f"angle_unit is {angle_unit!r}", remedy='pass angle_unit="rad" or angle_unit="deg"')
    headers = _own_names(table, dict(columns or {}))
    joints = _joints(table, headers) if joint_names is None else _named(joint_names)
    present = _present(table, headers, joints)
    names = ("time", *(f"{quantity}_{joint}" for quantity in present for joint in joints))
    where = SourceLocation(table.file, table.lines, headers, table.row_name)
    checks.refuse_too_few(len(table), where)
    numbers = table.numbers([headers[name] for name in names])
    checks.refuse_not_finite(numbers, names, where)
    time = numbers[:, 0]
    checks.refuse_time_disorder(time, where)
    checks.refuse_absurd(numbers[:, 1:], names[1:], where)
    blocks = np.split(numbers[:, 1:], len(present), axis=1)
    arrays = {
        quantity: np.deg2rad(block) if angle_unit == "deg" and quantity != "tau" else block
        for quantity, block in zip(present, blocks, strict=True)
    }
    checks.refuse_degrees(arrays["q"], names[1 : 1 + len(joints)], largest_angle, where)
    if "v" in arrays:
        checks.refuse_velocity_in_other_unit(time, arrays["q"], arrays["v"], joints, where)
    return Log(time, arrays, joints, table.source, where)


def read_mask(table: Table, column: str) -> BoolArray:
    """Read which samples count from a column of 0 and 1.

    Args:
        table: Columns of the file.
        column: Its header.

    Returns:
        The mask, (N,).

    Raises:
        ExoidError: There is no such column, or it has other values.
    """
    if column not in table.header:
        missing = _missing(column, "it is to be the mask", table)
        raise ExoidError(missing.what, where=missing.where, remedy="name a column of 0 and 1 as mask")
    try:
        return checks.as_mask(table.numbers([column])[:, 0])
    except ExoidError as error:
        raise ExoidError(error.what, where=f"{table.file}, column {column}", remedy=error.remedy) from None


def _own_names(table: Table, columns: Mapping[str, str]) -> dict[str, str]:
    """Map exoid's column names to headers of the file: by ``columns``, and by equal name for the others."""
    for name, header in columns.items():
        if name != "time" and not (name.startswith(tuple(f"{quantity}_" for quantity in QUANTITIES))):
            raise ExoidError(
                f"columns names {name!r}, which is not an exoid column",
                where=table.file,
                remedy="exoid columns are time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>",
            )
        if header not in table.header:
            raise _missing(header, f"columns[{name!r}] asks for it", table)
        rivals = [other for other, used in columns.items() if used == header]
        if len(rivals) > 1:
            raise ExoidError(
                f"column {header!r} is to be read as {' and '.join(rivals)}",
                where=table.file,
                remedy="map each exoid column to a different header",
            )
    taken = set(columns.values())
    return {**{header: header for header in table.header if header and header not in taken}, **columns}


def _joints(table: Table, headers: Mapping[str, str]) -> tuple[str, ...]:
    """Take the joints from the q_ columns, in the order of the file."""
    angles = [name for name in headers if name.startswith("q_")]
    if not angles:
        raise _missing("q_<joint>", "no joint angle", table)
    joints = _named([name[2:] for name in sorted(angles, key=lambda name: table.header.index(headers[name]))])
    for name, header in headers.items():
        if name not in (header, "time") and name.partition("_")[2] not in joints:
            raise ExoidError(
                f"columns names {name!r}, but no column gives the angle of that joint",
                where=table.file,
                remedy=f"joints with an angle are {', '.join(joints)}; map q_<joint> too",
                command=f"joints with an angle are {', '.join(joints)}; give q_<joint>=HEADER to --column too",
            )
    return joints


def _named(joint_names: Sequence[str]) -> tuple[str, ...]:
    if isinstance(joint_names, str):
        raise ExoidError(f"joint_names is the string {joint_names!r}", remedy=f"pass joint_names=({joint_names!r},)")
    names = tuple(joint_names)
    checks.refuse_names(names)
    if not names:
        raise ExoidError("joint_names is empty", remedy="name at least one joint")
    return names


def _present(table: Table, headers: Mapping[str, str], joints: Sequence[str]) -> list[str]:
    """List the quantities that the file has for these joints: q, and others that all joints have."""
    if "time" not in headers:
        raise _missing("time", "no time stamps", table)
    present = []
    for quantity in QUANTITIES:
        absent = [f"{quantity}_{joint}" for joint in joints if f"{quantity}_{joint}" not in headers]
        if quantity == "q" and absent:
            raise _missing(absent[0], "no angle for that joint", table)
        if 0 < len(absent) < len(joints):
            raise _missing(absent[0], "other joints have one; joint_names selects joints", table)
        if not absent:
            present.append(quantity)
    return present


def _missing(column: str, why: str, table: Table) -> ExoidError:
    """Make the error about a missing column, which names the closest and the existing ones."""
    close = get_close_matches(column, table.header, n=3, cutoff=0.4)
    nearest = f"; closest: {', '.join(close)}" if close else ""
    name = column if not why.startswith("columns[") else why[len("columns['") : why.index("']")]
    exists = ", ".join(table.header[:20]) + (f", … ({len(table.header)} in all)" if len(table.header) > 20 else "")
    return ExoidError(
        f"no column {column!r} ({why}){nearest}; the file has: {exists}",
        where=table.file,
        remedy=f"rename it in the file or pass columns={{{column!r}: <header in the file>}}"
        if not why.startswith("columns[")
        else "pass columns={exoid's name: <header in the file>}",
        command=f"rename it in the file or give its header: --column {name}=HEADER",
    )
