"""Fields of a recording from the table of a log file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from exoid.leg.payload import Payload

from . import checks, timebase
from .base_log import read_base
from .column import Column
from .external_log import read_external
from .log import payloads_of, read_log, read_mask
from .readers import Table
from .wrench_frame import WrenchFrame


@dataclass(frozen=True)
class LogOptions:
    """What a caller says about a log; see :meth:`exoid.Recording.from_file`."""

    joint_names: Sequence[str] | None  # joints to read; None for all
    columns: Mapping[str, str | Column] | None  # header in the file of each exoid column whose name differs
    angle_unit: Literal["rad", "deg"]  # unit of angles in the file
    largest_angle: float  # limit of the angles [rad]
    resample: bool  # whether uneven time stamps are resampled
    mask: str | None  # header of the column of samples that count
    passive: Sequence[str]  # joints without an actuator
    unmeasured: Sequence[str]  # joints whose torque column is not read
    payloads: Sequence[Payload] | None  # payloads on the leg; None for those of the file
    base_position: Sequence[float] | None  # position of the sensor on the base [m], (3,); None for that of the file
    # axes and points of wrenches by link; None for those of the file
    wrench_frames: Mapping[str, WrenchFrame | str] | None


def fields_of(table: Table, said: LogOptions) -> dict[str, Any]:
    """Read a table."""
    log = read_log(table, said.joint_names, said.columns, said.angle_unit, said.largest_angle, said.unmeasured)
    loads = payloads_of(table, said.payloads)
    if said.resample and not timebase.is_uniform(log.time):
        timebase.refuse_gaps(log.time, log.where)
    return {
        "time": log.time,
        **log.arrays,
        "joint_names": log.joint_names,
        "source": log.source,
        "mask": None if said.mask is None else read_mask(table, said.mask),
        "largest_angle": said.largest_angle,
        "passive": checks.as_joints(said.passive, log.joint_names, "passive"),
        "payloads": loads,
        "base": read_base(table, log.time, log.base, said.base_position),
        **read_external(table, log.external, said.wrench_frames),
    }
