"""Protocols as CSV files for a real rig, and static logs of the rig.

Logs of motions have the columns of :class:`exoid.Recording` (``time, q_<joint>, tau_<joint>``). Static logs have one
row a reading, ``pose, approach, q_<joint>, tau_<joint>``. The approach is +1 if the joints moved up to the pose and −1
if they moved down to it. Readings of the same pose are averaged.
"""

from __future__ import annotations

import csv
import hashlib
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.leg.torso import TorsoMotion
from exoid.rig import Reference
from exoid.signals import Approaches, Poses
from exoid.signals.csv_writer import write_csv
from exoid.signals.source import Source

from .limits import refuse_motion_beyond_limits, refuse_poses_beyond_limits

Name = str | os.PathLike[str]

UP, DOWN = 1.0, -1.0
"""Directions of approach: from below, and from above."""


def write_static_protocol(path: Name, leg: Leg, poses: ArrayLike, distance: float) -> None:
    """Write poses to approach from both sides: ``pose, approach, start_<joint>, q_<joint>`` [rad]."""
    refuse_poses_beyond_limits(leg, poses)
    if not 0.0 < distance < np.inf:
        raise ExoidError(f"a distance of {distance:g} rad", remedy="pass a positive distance")
    angles = np.repeat(np.asarray(poses, dtype=np.float64), 2, axis=0)
    number = np.repeat(np.arange(len(angles) // 2), 2)
    side = np.tile([UP, DOWN], len(angles) // 2)
    start = np.clip(angles - side[:, None] * distance, leg.limits.lower, leg.limits.upper)
    write_csv(
        path,
        ["pose", "approach", *_columns("start", leg.joint_names), *_columns("q", leg.joint_names)],
        np.column_stack([number, side, start, angles]),
    )


def write_motion(path: Name, leg: Leg, reference: Reference, rate: float, duration: float) -> None:
    """Write a motion sampled at the controller's rate: ``time, q_<joint>, v_<joint>`` [s, rad, rad/s]."""
    if not 0.0 < rate < np.inf:
        raise ExoidError(f"a rate of {rate:g} Hz", remedy="pass a positive rate")
    refuse_motion_beyond_limits(leg, reference, duration)
    time = np.arange(round(duration * rate) + 1) / rate
    targets = [reference.at(float(t)) for t in time]
    q, v = np.array([(target.q[:, 0], target.v[:, 0]) for target in targets]).swapaxes(0, 1)
    header = ["time", *_columns("q", leg.joint_names), *_columns("v", leg.joint_names)]
    write_csv(path, header, np.column_stack([time, q, v]))


def write_static_log(path: Name, approaches: Approaches) -> None:
    """Write measurements of poses approached from both sides, in the format of :func:`read_static_log`."""
    names, number = approaches.below.joint_names, np.arange(len(approaches.below))
    tables = [
        np.column_stack([number, np.full(len(number), side), poses.q, poses.tau])
        for side, poses in ((UP, approaches.below), (DOWN, approaches.above))
    ]
    write_csv(path, _log_columns(names), np.vstack(tables))


def read_static_log(path: Name, joint_names: Sequence[str], torso: TorsoMotion | None = None) -> Approaches:
    """Read measurements of poses approached from both sides."""
    try:
        content = Path(path).read_bytes()
        lines = list(csv.reader(content.decode("utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ExoidError(f"cannot be read ({error})", where=str(path), remedy="give a CSV file") from error
    table = _table(lines, _log_columns(joint_names), str(path))
    number, side = table[:, 0], table[:, 1]
    wrong = np.flatnonzero((side != UP) & (side != DOWN))
    if len(wrong):
        raise ExoidError(
            f"approach {side[wrong[0]]:g} of pose {number[wrong[0]]:g}",
            where=str(path),
            remedy="write +1 if joints moved up to the pose, −1 if they moved down",
        )
    source = Source(Path(path).name, hashlib.sha256(content).hexdigest())
    below, above = (_mean_of_readings(table, direction, str(path)) for direction in (UP, DOWN))
    n, names = len(joint_names), tuple(joint_names)
    return Approaches(*(Poses(x[:, 2 : 2 + n], x[:, 2 + n :], names, torso, source) for x in (below, above)))


def _mean_of_readings(table: FloatArray, direction: float, name: str) -> FloatArray:
    """Average the readings of each pose in one direction, in the order of the pose numbers."""
    numbers, of_direction = np.unique(table[:, 0]), table[table[:, 1] == direction]
    absent = sorted(set(numbers.tolist()) - set(of_direction[:, 0].tolist()))
    if absent:
        raise ExoidError(
            f"pose {absent[0]:g} has no reading with approach {direction:+g}",
            where=name,
            remedy="measure each pose from both sides, or remove it",
        )
    return np.array([of_direction[of_direction[:, 0] == number].mean(axis=0) for number in numbers])


def _table(lines: Sequence[Sequence[str]], columns: Sequence[str], name: str) -> FloatArray:
    """Read columns by their headers."""
    header = [cell.strip() for cell in lines[0]] if lines else []
    missing = [column for column in columns if header.count(column) != 1]
    if missing:
        raise ExoidError(
            f"not one column {', '.join(missing)}", where=name, remedy=f"write each of {', '.join(columns)} once"
        )
    places = [header.index(column) for column in columns]
    rows = [(number, line) for number, line in enumerate(lines[1:], start=2) if any(cell.strip() for cell in line)]
    if not rows:
        raise ExoidError("no readings below the header", where=name, remedy="write one row a reading")
    return np.array(
        [[_number(line, place, f"{name}, line {k}, column {place + 1}") for place in places] for k, line in rows]
    )


def _number(line: Sequence[str], place: int, where: str) -> float:
    cell = line[place] if place < len(line) else ""
    try:
        value = float(cell)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise ExoidError(f"{cell[:40]!r} is not a finite number", where=where, remedy="correct it, or remove the row")
    return value


def _log_columns(joint_names: Sequence[str]) -> list[str]:
    return ["pose", "approach", *_columns("q", joint_names), *_columns("tau", joint_names)]


def _columns(prefix: str, joint_names: Sequence[str]) -> list[str]:
    return [f"{prefix}_{name}" for name in joint_names]
