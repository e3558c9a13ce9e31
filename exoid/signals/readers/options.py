"""Options for reading a log: one table for all functions that read logs."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal, TypedDict

from exoid.errors import BadArgumentError

if TYPE_CHECKING:
    from exoid.leg.payload import Payload
    from exoid.signals.wrench import WrenchFrame


class ReadOptions(TypedDict, total=False):
    """Options for reading a log, each of which may be left out.

    Attributes:
        beside: Other files of the same clock, whose columns are interpolated at the time stamps of the first one, such
            as torques of an inverse dynamics. Of columns of one name that of the first file counts. Each file says
            itself the unit of its angles, if it is OpenSim's, and by lines above its header the axes of its wrenches.
        gaps: "refuse" gaps and repeated stamps (if left out), or "split" the log there: rows in a gap and 0.5 s around
            it do not count, nor do rows with the stamp of the row before.
        angle_unit: Unit of angles in the file; "deg" applies to q, v and a that have no unit in ``columns``.
        largest_angle: Limit of the angles [rad], beyond which they count as degrees; 2π if left out.
        resample: Whether to resample uneven time stamps, as :meth:`exoid.Recording.resampled` does; True if left out.
        topic: Topic of joint states, for a bag with several.
        stamps: Time stamps of a bag: "header", when the joints were measured (if left out), or "received", when the
            message was recorded.
        mask: Header of a column of 0 and 1; only samples with 1 count. Bags have no such column.
        passive: Joints without an actuator, whose torque is zero.
        unmeasured: Joints whose torque column is not read, such as that of a dead channel.
        payloads: Payloads on the leg; None for those that lines ``# payload: …`` of a text file name.
        base_position: Position of the sensor of ``base_gyro_x…z`` and ``base_acc_x…z`` in the axes of the root link
            [m], (3,); None for that of the line ``# base position: …``, or else the origin of the root link.
        wrench_frames: Axes of the wrench on each link and the point its moment is about [m], such as
            ``{"left_foot": "link@0,0,-0.08"}`` or ``{"left_foot": "world"}``; None for those of the lines
            ``# wrench: left_foot:world``, or else axes and origin of the link.
    """

    beside: Sequence[str | os.PathLike[str]]
    gaps: Literal["refuse", "split"]
    angle_unit: Literal["rad", "deg"]
    largest_angle: float
    resample: bool
    topic: str | None
    stamps: Literal["header", "received"]
    mask: str | None
    passive: Sequence[str]
    unmeasured: Sequence[str]
    payloads: Sequence[Payload] | None
    base_position: Sequence[float] | None
    wrench_frames: Mapping[str, WrenchFrame | str] | None


class ReadRequest(ReadOptions, total=False):
    """Options of a caller, and the joints and columns that the reader of a format may need to know.

    Attributes:
        joint_names: Joints to read; None for those in the file.
        columns: Name in the file of each exoid column whose name differs.
    """

    joint_names: Sequence[str] | None
    columns: Mapping[str, str]


def refuse_unknown_options(options: Mapping[str, object]) -> None:
    """Refuse a misspelt option, as Python does for arguments."""
    for name in options:
        if name not in ReadOptions.__optional_keys__:
            raise TypeError(
                f"unexpected option {name!r}; options are {', '.join(sorted(ReadOptions.__optional_keys__))}"
            )
    for name, known in (("angle_unit", ("rad", "deg")), ("gaps", ("refuse", "split"))):
        if options.get(name, known[0]) not in known:
            remedy = f'pass {name}="{known[0]}" or {name}="{known[1]}"'
            raise BadArgumentError(f"{name} is {options[name]!r}", remedy=remedy)
