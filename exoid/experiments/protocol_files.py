"""Protocols as CSV files for a real rig, and static logs read back from it.

Motions are logged as :class:`exoid.Recording` reads them (``time, q_<joint>, tau_<joint>``). Static logs have one row a
reading, ``pose, approach, q_<joint>, tau_<joint>`` with approach +1 where the joints moved upwards to the pose and −1
where they moved down to it; several readings of one pose are averaged.
"""

from __future__ import annotations

import csv
import hashlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.files import write_whole
from exoid.leg import Leg
from exoid.rig import Reference
from exoid.signals import Approaches, Poses
from exoid.signals.source import Source

from .limits import refuse_motion_beyond_limits, refuse_poses_beyond_limits

Path_ = str | os.PathLike[str]


def write_static_protocol(path: Path_, leg: Leg, poses: FloatArray, distance: float) -> None:
    """Write poses to go to from both sides: ``pose, approach, start_<joint>, q_<joint>`` [rad].

    Args:
        path: File to write, whole or not at all.
        leg: Whose limits are checked.
        poses: Angles [rad], (K, n).
        distance: How far off the pose each joint starts [rad].

    Raises:
        ExoidError: A pose is beyond the limits, or the file cannot be written.
    """
    refuse_poses_beyond_limits(leg, poses)
    lower, upper, *_ = leg.limits
    header = ["pose", "approach", *(f"start_{n}" for n in leg.joint_names), *(f"q_{n}" for n in leg.joint_names)]
    rows = (
        [k, side, *np.clip(pose - side * distance, lower, upper).tolist(), *pose.tolist()]
        for k, pose in enumerate(poses)
        for side in (1, -1)
    )
    write_whole(path, _lines(header, rows))


def write_motion(path: Path_, leg: Leg, reference: Reference, rate: float, duration: float) -> None:
    """Write a motion sampled at the controller's rate: ``time, q_<joint>, v_<joint>`` [s, rad, rad/s].

    Args:
        path: File to write, whole or not at all.
        leg: Whose limits are checked.
        reference: The motion, of one rig.
        rate: Of the controller [Hz].
        duration: [s].

    Raises:
        ExoidError: The motion is beyond the limits, or the file cannot be written.
    """
    refuse_motion_beyond_limits(leg, reference, duration)
    header = ["time", *(f"q_{n}" for n in leg.joint_names), *(f"v_{n}" for n in leg.joint_names)]

    def rows() -> Iterator[list[float]]:
        for t in np.arange(round(duration * rate) + 1) / rate:
            q, v = reference.at(float(t))
            yield [float(t), *np.asarray(q)[:, 0].tolist(), *np.asarray(v)[:, 0].tolist()]

    write_whole(path, _lines(header, rows()))


def read_static_log(path: Path_, joint_names: Sequence[str]) -> Approaches:
    """Read what a rig measured at poses reached from both sides.

    Args:
        path: The log.
        joint_names: Joints wanted.

    Returns:
        Each pose from below and from above, in the order of the pose numbers.

    Raises:
        ExoidError: A column is missing, a cell is no number, or a pose was not reached from both sides.
    """
    try:
        content = Path(path).read_bytes()
        rows = list(csv.DictReader(content.decode("utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ExoidError(f"cannot be read ({error})", where=str(path), remedy="give a CSV file") from error
    columns = ["pose", "approach", *(f"q_{n}" for n in joint_names), *(f"tau_{n}" for n in joint_names)]
    missing = [name for name in columns if not rows or name not in rows[0]]
    if missing:
        raise ExoidError(f"no column {', '.join(missing)}", where=str(path), remedy=f"columns are {', '.join(columns)}")
    table = np.array([_numbers(row, columns, line, str(path)) for line, row in enumerate(rows, start=2)])
    numbers = np.unique(table[:, 0])
    sides = {}
    for side in (1.0, -1.0):
        of_side = table[table[:, 1] == side]
        absent = sorted(set(numbers) - set(of_side[:, 0]))
        if absent:
            raise ExoidError(
                f"pose {absent[0]:g} was not reached with approach {side:+g}",
                where=str(path),
                remedy="measure each pose from both sides, or leave it out",
            )
        sides[side] = np.array([of_side[of_side[:, 0] == number].mean(axis=0) for number in numbers])
    n, names = len(joint_names), tuple(joint_names)
    source = Source(Path(path).name, hashlib.sha256(content).hexdigest())
    below, above = (Poses(t[:, 2 : 2 + n], t[:, 2 + n :], names, source=source) for t in (sides[1.0], sides[-1.0]))
    return Approaches(below, above)


def _numbers(row: dict[str, str], columns: Sequence[str], line: int, name: str) -> list[float]:
    values = []
    for column in columns:
        try:
            value = float(row[column])
        except (TypeError, ValueError):
            value = float("nan")
        if not np.isfinite(value):
            raise ExoidError(
                f"{row[column]!r} is no finite number", where=f"{name}, line {line}, column {column}", remedy="mend it"
            )
        values.append(value)
    return values


def _lines(header: Sequence[str], rows: Iterator[list[float]]) -> Iterator[str]:
    yield ",".join(header) + "\n"
    for row in rows:
        yield ",".join(map(repr, row)) + "\n"
