"""Base motion, wrenches and contacts among the columns of a log, read and written."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import UnreadableInputError, within

from . import checks
from .base_motion import BASE_COLUMNS, BaseMotion
from .base_pose import POSE_COLUMNS, BasePose
from .csv_writer import LogPart
from .readers import Table
from .readers.text import BASE_POSITION, WRENCH
from .wrench import WRENCH_PARTS, Wrench, WrenchFrame, frame_of_link

POINT_PARTS = ("px", "py", "pz")
"""Coordinates of a point that moves, in the laboratory [m]."""

WRENCH_COLUMN = re.compile(r"wrench_(?P<link>.+)_(?P<part>[fmp][xyz])")
"""Name of a column of a wrench, such as ``wrench_left_foot_fz``."""

CONTACT = "contact_"
"""Beginning of the name of a column of 0 and 1."""


def is_external(name: str) -> bool:
    """Tell whether a name is that of a column of a wrench or a contact."""
    return WRENCH_COLUMN.fullmatch(name) is not None or (name.startswith(CONTACT) and name != CONTACT)


def part_columns(headers: Mapping[str, str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Find the columns of the base (those of an IMU, of a pose, or of both), and those of wrenches and contacts."""
    of_base: list[str] = []
    for names in (BASE_COLUMNS, POSE_COLUMNS):
        if _has_all(names, headers, "the motion of the base"):
            of_base += names
    external = tuple(name for name in headers if is_external(name))
    for link in _links(external):
        measured = [name for name in _named(link, WRENCH_PARTS) if name in external]
        if len(measured) != 1:  # one is a sensor of one axis: it measures all that acts there
            _has_all(_named(link, WRENCH_PARTS), external, f"the wrench on {link}", needed=True)
        _has_all(_named(link, POINT_PARTS), external, f"the wrench on {link}")
    return tuple(of_base), external


def _has_all(names: Sequence[str], there: Iterable[str], what: str, *, needed: bool = False) -> bool:
    """Whether all columns of something are there; some of them alone are refused."""
    absent = [name for name in names if name not in there]
    if absent and (needed or len(absent) < len(names)):
        raise UnreadableInputError(
            f"{what} lacks {', '.join(absent)}",
            remedy=f"give all of {', '.join(names)}; a column of zeros says that a component is none",
            command=f"give their headers: --column {absent[0]}=HEADER",
        )
    return not absent


def matrix_headers(header: Sequence[str]) -> dict[str, str]:
    """Name the columns of matrices ``base_gyro`` and ``base_acc`` (samples, 3) and ``wrench_<link>`` (samples, 6)."""
    base = {f"base_{kind}_{axis}": f"base_{kind}[{k}]" for kind in ("gyro", "acc") for k, axis in enumerate("xyz")}
    found = {name: column for name, column in base.items() if column in header}
    for column in header:
        if match := re.fullmatch(r"wrench_(.+)\[([0-5])\]", column):
            found[f"wrench_{match[1]}_{WRENCH_PARTS[int(match[2])]}"] = column
    return found


def read_base(
    table: Table, time: FloatArray, columns: Mapping[str, FloatArray], position: Sequence[float] | None
) -> BaseMotion | None:
    """Make the base motion of a log."""
    # With the columns of an IMU, those of a pose say only how the root link stands in the laboratory.
    said = _said_position(table)
    if not columns:
        if position is not None:
            raise UnreadableInputError(
                "a position of the base's sensor, and no motion of the base",
                remedy=f"give columns {', '.join(BASE_COLUMNS)}, or leave out base_position",
                command=f"give headers of {', '.join(BASE_COLUMNS)} to --column, or leave out --base-position",
            )
        return None
    place = position if position is not None else said or (0.0, 0.0, 0.0)
    values = np.column_stack(list(columns.values()))
    imu, pose = values[:, :-7], values[:, -7:]
    if tuple(columns) == BASE_COLUMNS:
        return BaseMotion.from_imu(values[:, :3], values[:, 3:], position=place)
    if tuple(columns) == POSE_COLUMNS:
        return BaseMotion.from_pose(pose[:, :3], pose[:, 3:], time, at=place)
    return BaseMotion.from_imu(imu[:, :3], imu[:, 3:], position=place, pose=BasePose(pose[:, :3], pose[:, 3:]))


def _said_position(table: Table) -> tuple[float, ...] | None:
    """Position that a line of a text file gives."""
    texts = table.said.get(BASE_POSITION, ())
    if not texts:
        return None
    try:
        (text,) = texts
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise UnreadableInputError(
            f"{' and '.join(texts)} is no position of the base's sensor",
            where="line of a base position",
            remedy="write one line '# base position: x,y,z' in m",
        ) from None
    return x, y, z


def log_of_base(base: BaseMotion) -> LogPart:
    """Name the columns of a base motion, and write the position of its sensor as a line above the header."""
    comment = f"{BASE_POSITION} {','.join(map(repr, base.position.tolist()))}"
    if base.pose is None:
        return LogPart(BASE_COLUMNS, [base.columns], [comment])
    return LogPart((*BASE_COLUMNS, *POSE_COLUMNS), [base.columns, base.pose.columns], [comment])


def read_external(
    table: Table, columns: Mapping[str, FloatArray], given_frames: Mapping[str, WrenchFrame | str] | None
) -> dict[str, Any]:
    """Make the wrenches and contacts of a log."""
    said: dict[str, WrenchFrame] = {}
    for text in table.said.get(WRENCH, ()):
        with within(f"line '{WRENCH}'"):
            said.update([frame_of_link(text)])
    with within("wrench_frames"):
        given = {
            link: WrenchFrame.from_text(frame) if isinstance(frame, str) else WrenchFrame(*frame)
            for link, frame in (given_frames or {}).items()
        }
    links = _links(columns)
    for link in given:
        if link not in links:
            raise UnreadableInputError(
                f"axes of the wrench on {link}, which the log does not have",
                remedy=f"links with a wrench are {', '.join(links) or 'none'}: name one of them",
                command=f"links with a wrench are {', '.join(links) or 'none'}; map its columns, e.g. "
                f"--column wrench_{link}_fx=HEADER, or leave out --wrench {link}:…",
            )
    frames = {**said, **given}
    # Without a frame, a wrench is in the axes of its link, about its origin; one whose point moves is in the
    # laboratory.
    wrenches: dict[str, Wrench] = {}
    for link in links:
        with within(f"wrench on {link}"):
            wrenches[link] = _wrench(link, columns, frames.get(link))
    contacts: dict[str, BoolArray] = {}
    for name in (name for name in columns if name.startswith(CONTACT)):
        with within(f"column {name}"):
            contacts[name.removeprefix(CONTACT)] = checks.as_mask(columns[name], "a contact")
    return {"wrenches": wrenches, "contacts": contacts}


def _wrench(link: str, columns: Mapping[str, FloatArray], frame: WrenchFrame | None) -> Wrench:
    zeros = np.zeros(len(next(iter(columns.values()))))
    values = np.column_stack([columns.get(name, zeros) for name in _named(link, WRENCH_PARTS)])
    names = _named(link, POINT_PARTS)
    if names[0] not in columns:
        axes, point = frame or WrenchFrame("link")
        return Wrench(values[:, :3], values[:, 3:], (0.0, 0.0, 0.0) if point is None else point, axes)  # type: ignore[arg-type]
    if frame is not None and (frame.axes != "world" or frame.point is not None):
        raise UnreadableInputError(
            f"the point of the wrench is given by columns {', '.join(names)} in the laboratory, and as {frame}",
            remedy="leave out one of both; columns of a point belong to axes world",
        )
    point_columns = np.column_stack([columns[name] for name in names])
    return Wrench(values[:, :3], values[:, 3:], point_columns, "world")


def _named(link: str, parts: Sequence[str]) -> tuple[str, ...]:
    """Name columns of the wrench on a link."""
    return tuple(f"wrench_{link}_{part}" for part in parts)


def log_of_external(wrenches: Mapping[str, Wrench], contacts: Mapping[str, BoolArray]) -> LogPart:
    """Name the columns of wrenches and contacts, and write axes and points as lines above the header."""
    names: list[str] = []
    columns: list[FloatArray] = []
    comments = []
    for link, wrench in wrenches.items():
        names += _named(link, WRENCH_PARTS)
        columns.append(wrench.columns)
        if wrench.moving_point:
            names += _named(link, POINT_PARTS)
            columns.append(wrench.point)
        point = None if wrench.moving_point else tuple(wrench.point.tolist())
        comments.append(f"{WRENCH} {link}:{WrenchFrame(wrench.axes, point)}")
    names += [f"{CONTACT}{link}" for link in contacts]
    columns += [contact.astype(np.float64)[:, np.newaxis] for contact in contacts.values()]
    return LogPart(names, columns, comments)


def _links(names: Iterable[str]) -> tuple[str, ...]:
    """Links with a wrench, each once."""
    return tuple(dict.fromkeys(match["link"] for match in map(WRENCH_COLUMN.fullmatch, names) if match))
