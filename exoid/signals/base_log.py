"""Base motion among the columns of a log."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError, within

from .base_motion import BASE_COLUMNS, BaseMotion
from .base_pose import POSE_COLUMNS, BasePose
from .csv_writer import LogPart
from .readers import Table
from .readers.text import BASE_POSITION


def base_columns(table: Table, headers: Mapping[str, str]) -> tuple[str, ...]:
    """Find the columns of the base: those of an IMU, of a pose, or of both."""
    # Matrices of three columns, `base_gyro` and `base_acc`, count as well.
    whole = tuple(name for name in (*BASE_COLUMNS, *POSE_COLUMNS) if name in headers)
    if whole == (*BASE_COLUMNS, *POSE_COLUMNS):
        return whole
    for names in (BASE_COLUMNS, POSE_COLUMNS):
        absent = [name for name in names if name not in headers]
        if not absent:
            return names
        if len(absent) < len(names):
            raise UnreadableInputError(
                f"the motion of the base lacks {', '.join(absent)}",
                where=table.file,
                remedy=f"give all of {', '.join(names)}, or none",
                command=f"give their headers: --column {absent[0]}=HEADER",
            )
    return ()


def matrix_headers(header: Sequence[str]) -> dict[str, str]:
    """Name the columns of matrices ``base_gyro`` and ``base_acc`` of (samples, 3)."""
    names = {f"base_{kind}_{axis}": f"base_{kind}[{k}]" for kind in ("gyro", "acc") for k, axis in enumerate("xyz")}
    return {name: column for name, column in names.items() if column in header}


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
                where=table.file,
                remedy=f"give columns {', '.join(BASE_COLUMNS)}, or leave out base_position",
                command=f"give headers of {', '.join(BASE_COLUMNS)} to --column, or leave out --base-position",
            )
        return None
    if position is not None and said is not None and tuple(position) != said:
        raise UnreadableInputError(
            f"the file puts the base's sensor at {said} m, and not at {tuple(position)} m",
            where=table.file,
            remedy="leave out base_position, or correct the line '# base position:' of the file",
            command="leave out --base-position, or correct the line '# base position:' of the file",
        )
    place = position if position is not None else said or (0.0, 0.0, 0.0)
    values = np.column_stack(list(columns.values()))
    imu, pose = values[:, :-7], values[:, -7:]
    with within(table.file):
        if tuple(columns) == BASE_COLUMNS:
            return BaseMotion.from_imu(values[:, :3], values[:, 3:], position=place)
        if tuple(columns) == POSE_COLUMNS:
            return BaseMotion.from_pose(pose[:, :3], pose[:, 3:], time, at=place)
        return BaseMotion.from_imu(imu[:, :3], imu[:, 3:], position=place, pose=BasePose(pose[:, :3], pose[:, 3:]))


def log_of_base(base: BaseMotion) -> LogPart:
    """Name the columns of a base motion, and write the position of its sensor as a line above the header."""
    comment = f"{BASE_POSITION} {','.join(map(repr, base.position.tolist()))}"
    if base.pose is None:
        return LogPart(BASE_COLUMNS, [base.columns], [comment])
    return LogPart((*BASE_COLUMNS, *POSE_COLUMNS), [base.columns, base.pose.columns], [comment])


def _said_position(table: Table) -> tuple[float, ...] | None:
    """Position that a line of a text file gives."""
    texts = getattr(table, "said", {}).get(BASE_POSITION, ())
    if not texts:
        return None
    try:
        (text,) = texts
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise UnreadableInputError(
            f"{' and '.join(texts)} is no position of the base's sensor",
            where=f"{table.file}, line of a base position",
            remedy="write one line '# base position: x,y,z' in m",
        ) from None
    return x, y, z
