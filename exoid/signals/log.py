"""Reading a log: finds time, angles, velocities, accelerations and torques among its columns, and checks them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError, UnreadableInputError, within
from exoid.leg.description import LARGEST_ANGLE
from exoid.leg.payload import Payload, as_payloads

from . import checks, timebase
from .base_motion import BASE_COLUMNS
from .base_pose import POSE_COLUMNS, continuous
from .column import Column
from .log_parts import is_external, matrix_headers, part_columns, read_base, read_external
from .quantities import QUANTITIES, refuse_silent_unit
from .readers import ReadOptions, Table
from .readers.opensim import TRANSLATIONS
from .readers.text import PAYLOAD
from .source import SourceLocation

PARTIAL = tuple(f"{quantity.prefix}_" for quantity in QUANTITIES if quantity.partial)
ANGULAR = tuple(f"{quantity.prefix}_" for quantity in QUANTITIES if quantity.angular)


def read_log(
    table: Table, joint_names: Sequence[str] | None, columns: Mapping[str, Column], options: ReadOptions
) -> dict[str, Any]:
    """Take the fields of a recording from a table, and check them; see `Recording.from_file`."""
    headers = _own_names(table, {name: column.header for name, column in columns.items()})
    joints = _joints(table, headers) if joint_names is None else _named(joint_names)
    left_out = {f"tau_{joint}" for joint in checks.as_joints(options.get("unmeasured", ()), joints, "unmeasured")}
    headers = {name: header for name, header in headers.items() if name not in left_out}
    of_joints = _of_joints(table, headers, joints)
    of_base, of_links = part_columns(headers)
    names = ("time", *(name for of_quantity in of_joints.values() for name in of_quantity), *of_base, *of_links)
    where = SourceLocation(table.lines, headers, table.row_name)
    checks.refuse_too_few(len(table), where)
    numbers = _numbers(table, names, headers, columns, options.get("angle_unit") == "deg")
    missing = np.array([name.startswith(PARTIAL) for name in names]) & np.isnan(numbers).all(axis=0)
    kept = tuple(name for name, is_missing in zip(names, missing, strict=True) if not is_missing)
    checks.refuse_not_finite(numbers[:, ~missing], kept, where)
    mask = None if options.get("mask") is None else read_mask(table, str(options["mask"]))
    splits = options.get("gaps") == "split"
    if splits:
        new = np.append(True, np.diff(numbers[:, 0]) != 0.0)
        numbers, mask = numbers[new], None if mask is None else mask[new]
        where = SourceLocation(None if table.lines is None else table.lines[new], headers, table.row_name)
    checks.refuse_time_disorder(numbers[:, 0], where)
    checks.refuse_implausible("", numbers[:, ~missing][:, 1:], kept[1:], where)
    time, found = numbers[:, 0], dict(zip(names, numbers.T, strict=True))
    if splits:
        time, found, mask = _split_at_gaps(time, found, mask)
    arrays = _arrays(found, joints, of_joints)
    largest_angle = options.get("largest_angle", LARGEST_ANGLE)
    checks.refuse_degrees(arrays["q"], names[1 : 1 + len(joints)], largest_angle, where)
    if "v" in arrays:
        checks.refuse_velocity_in_other_unit(time, arrays["q"], arrays["v"], joints, where)
    payloads = payloads_of(table, options.get("payloads"))
    if options.get("resample", True) and not timebase.is_uniform(time):
        timebase.refuse_gaps(time, where)
    links = {name: found[name] for name in of_links}
    return {
        "time": time,
        **arrays,
        "joint_names": joints,
        "source": table.source,
        "mask": mask,
        "largest_angle": largest_angle,
        "passive": checks.as_joints(options.get("passive", ()), joints, "passive"),
        "payloads": payloads,
        "base": read_base(table, time, {name: found[name] for name in of_base}, options.get("base_position")),
        **read_external(table, links, options.get("wrench_frames")),
    }


def _split_at_gaps(
    time: FloatArray, found: dict[str, FloatArray], mask: BoolArray | None
) -> tuple[FloatArray, dict[str, FloatArray], BoolArray | None]:
    """Fill gaps with rows that do not count."""
    # q and −q are one orientation: no way leads from one to the other
    if turns := [found[name] for name in POSE_COLUMNS[3:] if name in found]:
        found = {**found, **dict(zip(POSE_COLUMNS[3:], continuous(np.column_stack(turns)).T, strict=True))}
    table, counted = timebase.split_at_gaps(np.column_stack(list(found.values())))
    if counted.all():
        return time, found, mask
    filled = dict(zip(found, table.T, strict=True))
    filled |= {name: np.round(values) for name, values in filled.items() if name.startswith("contact_")}
    kept = counted if mask is None else counted & timebase.interpolate_mask(time, mask, table[:, 0])
    return table[:, 0], filled, kept


def _arrays(
    found: Mapping[str, FloatArray], joints: Sequence[str], of_joints: Mapping[str, Sequence[str]]
) -> dict[str, FloatArray]:
    """Arrays by field, (N, n) each; columns that the file does not have are NaN throughout."""
    nothing = np.full(len(found["time"]), np.nan)
    arrays = {
        quantity.field: np.column_stack([found.get(f"{quantity.prefix}_{joint}", nothing) for joint in joints])
        for quantity in QUANTITIES
        if quantity.prefix in of_joints
    }
    return {field: values for field, values in arrays.items() if not np.isnan(values).all()}


def payloads_of(table: Table, given: Sequence[Payload] | None) -> tuple[Payload, ...]:
    """Find the payloads that were on the leg: those that were given, or those that the file names."""
    if given is not None:
        return as_payloads(given)
    try:
        return tuple(Payload.from_text(text) for text in table.said.get(PAYLOAD, ()))
    except ExoidError as error:
        remedy = f"{error.remedy}; or pass payloads=, () for none"
        command = f"{error.remedy}; or give --payload"
        raise UnreadableInputError(error.what, where=f"line '{PAYLOAD}'", remedy=remedy, command=command) from None


def read_mask(table: Table, column: str) -> BoolArray:
    """Read which samples count from a column of 0 and 1."""
    if column not in table.header:
        missing = _missing(column, "it is to be the mask", table)
        missing.remedy, missing.command = "name a column of 0 and 1 as mask", ""
        raise missing
    values = table.numbers([column])[:, 0]
    with within(f"column {column}"):
        return checks.as_mask(values)


def _own_names(table: Table, columns: Mapping[str, str]) -> dict[str, str]:
    """Map exoid's column names to headers of the file: by ``columns``, and by equal name for the others."""
    for name, header in columns.items():
        if not _is_of_no_joint(name) and not name.startswith(tuple(f"{each.prefix}_" for each in QUANTITIES)):
            raise UnreadableInputError(
                f"a header is given for {name!r}, which is not an exoid column",
                remedy="exoid columns are time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>, i_<joint>, f_<joint>, "
                f"tm_<joint>, qm_<joint>, {', '.join(BASE_COLUMNS)}, wrench_<link>_fx, …, "
                "wrench_<link>_mz, contact_<link>",
            )
        if header not in table.header:
            raise _missing(header, f"to be read as {name}", table, name)
        rivals = [other for other, used in columns.items() if used == header]
        if len(rivals) > 1 and not _may_share(rivals):
            what = f"column {header!r} is to be read as {' and '.join(rivals)}"
            raise UnreadableInputError(what, remedy="map each exoid column to a different header")
    taken = {header for name, header in columns.items() if not _may_share((name, header))}
    own = {header: header for header in table.header if header and header not in taken}
    return {**matrix_headers(table.header), **own, **columns}


def _is_of_no_joint(name: str) -> bool:
    return name in ("time", *BASE_COLUMNS, *POSE_COLUMNS) or is_external(name)


def _joints(table: Table, headers: Mapping[str, str]) -> tuple[str, ...]:
    """Take the joints from the q_ columns, in the order of the file."""
    angles = [name for name in headers if name.startswith("q_")]
    if not angles:
        raise _missing("q_<joint>", "no joint angle", table)
    joints = _named([name[2:] for name in sorted(angles, key=lambda name: table.header.index(headers[name]))])
    for name, header in headers.items():
        if name != header and not _is_of_no_joint(name) and name.partition("_")[2] not in joints:
            raise UnreadableInputError(
                f"columns names {name!r}, but no column gives the angle of that joint",
                remedy=f"joints with an angle are {', '.join(joints)}; map q_<joint> too",
                command=f"joints with an angle are {', '.join(joints)}; give q_<joint>=HEADER to --column too",
            )
    return joints


def _named(joint_names: Sequence[str]) -> tuple[str, ...]:
    names = checks.as_names(joint_names, "joint_names")
    checks.refuse_names(names)
    return names


def _of_joints(table: Table, headers: Mapping[str, str], joints: Sequence[str]) -> dict[str, list[str]]:
    """Columns of each quantity that the file has for these joints, by prefix: q, others of all joints, some torques."""
    if "time" not in headers:
        raise _missing("time", "no time stamps", table)
    found = {}
    for quantity in QUANTITIES:
        wanted = [f"{quantity.prefix}_{joint}" for joint in joints]
        absent = [name for name in wanted if name not in headers]
        if quantity.field == "q" and absent:
            raise _missing(absent[0], "no angle for that joint", table)
        if quantity.partial:
            if absent:
                _refuse_nameless(quantity.prefix, absent, headers, table)
        elif 0 < len(absent) < len(joints):
            raise _missing(absent[0], "other joints have one; joint_names selects joints", table)
        if len(absent) < len(joints):
            found[quantity.prefix] = [name for name in wanted if name in headers]
    return found


def _refuse_nameless(quantity: str, absent: Sequence[str], headers: Mapping[str, str], table: Table) -> None:
    """Refuse a column whose joint has no angle while a joint lacks that column: one of both names is misspelt."""
    known = {name[2:] for name in headers if name.startswith("q_")}
    for name in headers:
        joint = name.removeprefix(f"{quantity}_")
        if joint not in (name, *known) and get_close_matches(name, absent, n=1, cutoff=0.8):
            lacking = absent[0].removeprefix(f"{quantity}_")
            what = f"no angle belongs to column {name}, and no {name} to q_{lacking}: one of both names is misspelt"
            pairs = (f"q_{joint}={headers[f'q_{lacking}']}", f"{absent[0]}={headers[name]}")
            both = f"--column {pairs[0]}, or --column {pairs[1]}"
            raise UnreadableInputError(f"{what} (of {', '.join(table.header[:20])})", remedy=both, column=name)


def _numbers(
    table: Table, names: Sequence[str], headers: Mapping[str, str], given: Mapping[str, Column], degrees: bool
) -> FloatArray:
    """Read columns, and convert them to SI units, (N, k)."""
    numbers = table.numbers([headers[name] for name in names])
    numbers = numbers if numbers.flags.writeable else numbers.copy()
    for place, name in enumerate(names):
        column = given.get(name) or Column(headers[name])
        said = column.header in table.in_degrees
        if column.is_plain and name in given:
            refuse_silent_unit(column.header, name, degrees=degrees or said)
        if not column.is_plain:
            numbers[:, place] = column.read(name, numbers[:, place])
        is_in_m = said and column.header.removesuffix("/value").endswith(TRANSLATIONS)
        if (degrees or said) and column.unit is None and name.startswith(ANGULAR) and not is_in_m:
            numbers[:, place] = np.deg2rad(numbers[:, place])
    return numbers


def _may_share(names: Sequence[str]) -> bool:
    """Whether columns are current or force of a drive, and torque computed of it."""
    quantities, joints = zip(*(name.partition("_")[::2] for name in names), strict=True)
    same_joint = len(set(joints)) == 1 and len(set(quantities)) == len(names)
    return same_joint and {f"{quantity}_" for quantity in quantities} <= set(PARTIAL)


def _missing(column: str, why: str, table: Table, name: str | None = None) -> ExoidError:
    """Make the error about a missing column, or the header given for one of exoid's name; names the closest ones."""
    close = get_close_matches(column, table.header, n=3, cutoff=0.4)
    nearest = f"; closest: {', '.join(close)}" if close else ""
    exists = ", ".join(table.header[:20]) + (f", … ({len(table.header)} in all)" if len(table.header) > 20 else "")
    return UnreadableInputError(
        f"no column {column!r} ({why}){nearest}; the file has: {exists}",
        remedy=f"rename it in the file or pass columns={{{name or column!r}: <header in the file>}}",
        column=name or column,
        command=f"rename it in the file or give its header: --column {name or column}=HEADER",
    )
