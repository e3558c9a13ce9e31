"""Arguments of the command line: legs, logs and terms."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import typer

from exoid.actuators import Actuators, read_actuators
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.signals import Column, Recording, WrenchFrame
from exoid.signals.wrench_frame import frame_of_link
from exoid.torques import DEFAULT_TERMS, Term
from exoid.torques.catalog import term_by_name

from .legs import DATASETS, find_leg
from .messages import Amount, note
from .payloads import PayloadOptions, payloads_in, refuse_other_payloads
from .refusals import is_readable, refuse
from .segments import read_segments, refuse_other_segments

LegName = Annotated[
    str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF file, or a robot such as panda.")
]
LogNames = Annotated[
    list[str], typer.Argument(metavar="LOG...", help="Logs of any kind, or a dataset's name:train or name:test.")
]
EstimateName = Annotated[str, typer.Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")]
ColumnPairs = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="NAME=HEADER",
        help="The file's header for a column, e.g. q_hip=pos1; with :SCALE, :SCALE:ZERO and :UNIT where needed, e.g. "
        "tau_hip=current:0.118, q_hip=enc:deg, time=stamp:ms. Repeatable.",
    ),
]
Names = Annotated[
    str | None,
    typer.Option(
        "--names", metavar="A,B", help="Columns of logs without a header line: time,q_hip,tau_hip; empty: not read."
    ),
]
Format = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="NAME:JOINT",
        help="Log of one actuator: dephy, moteus or openexo, and its joint, e.g. moteus:knee.",
    ),
]
Passive = Annotated[
    str | None, typer.Option("--passive", metavar="A,B", help="Joints without an actuator: their torque is zero.")
]
Unmeasured = Annotated[
    str | None, typer.Option("--unmeasured", metavar="A,B", help="Joints whose torque column is not read.")
]
BasePosition = Annotated[
    str | None,
    typer.Option(
        "--base-position",
        metavar="X,Y,Z",
        help="Position of the IMU of base_gyro_x and base_acc_x in the axes of the root link [m].",
    ),
]
WrenchFrames = Annotated[
    list[str] | None,
    typer.Option(
        "--wrench",
        metavar="LINK:AXES[@X,Y,Z]",
        help="Axes (link or world) of the wrench on a link, and the point its moment is about [m], e.g. "
        "left_foot:link@0,0,-0.08. Repeatable.",
    ),
]
MovingBase = Annotated[
    bool,
    typer.Option("--moving-base", help="Parameters of a leg whose base moves in space; for legs that are not planar."),
]
FloatingBase = Annotated[
    bool,
    typer.Option("--floating-base", help="Rows of force and moment on the torso; for legs that stand or walk."),
]
Degrees = Annotated[bool, typer.Option("--degrees", help="Angles in the logs are degrees.")]
Start = Annotated[float | None, typer.Option(metavar="S", help="Use each log from this time stamp on [s].")]
Stop = Annotated[float | None, typer.Option(metavar="S", help="Use each log up to before this time stamp [s].")]
Report = Annotated[str | None, typer.Option(metavar="FILE.HTML", help="Write a report: one self-contained HTML page.")]
Topic = Annotated[str | None, typer.Option(metavar="NAME", help="Topic of joint states in a ROS bag.")]
Received = Annotated[
    bool,
    typer.Option("--received", help="Use the times of arrival in a bag, not those in the headers."),
]
Segments = Annotated[
    str | None,
    typer.Option(
        metavar="FILE.CSV", help="Use only these segments: columns start, stop [s]; log (file name) for several logs."
    ),
]
Mask = Annotated[str | None, typer.Option(metavar="HEADER", help="Use only samples with 1 in this column of 0 and 1.")]
DriveFile = Annotated[
    str | None,
    typer.Option(
        "--actuators",
        metavar="DRIVES.TOML",
        help="Drives of the joints, for logs of currents (i_), forces (f_), motor torques (tm_) or motor angles (qm_); "
        "bleex: its assumed cylinders.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]


class LogOptions(NamedTuple):
    """How to read logs."""

    column: ColumnPairs = None  # "NAME=HEADER" pairs
    degrees: Degrees = False  # whether angles are degrees
    start: Start = None  # first time stamp to use [s]
    stop: Stop = None  # first time stamp not to use [s]
    topic: Topic = None  # topic of joint states in bags; None for the only one
    received: Received = False  # whether the time in bags is that at which they received the messages
    segments: Segments = None  # CSV file of the segments that count; None for all
    mask: Mask = None  # header of a column of 0 and 1 that says which samples count; None for all
    names: Names = None  # names of the columns of files without a header line, separated by commas
    format: Format = None  # "NAME:JOINT" of the log of an actuator
    passive: Passive = None  # joints without an actuator, separated by commas
    unmeasured: Unmeasured = None  # joints whose torque column is not read, separated by commas
    payload: PayloadOptions = None  # "LOG=SEGMENT:KG@X,Y,Z" of payloads
    base_position: BasePosition = None  # position of the sensor on the base [m], "X,Y,Z"
    wrench: WrenchFrames = None  # "LINK:AXES@X,Y,Z" of wrenches

    def given(self) -> dict[str, object]:
        """List the options that were given."""
        return {
            f"--{name.replace('_', '-')}": None if value == self._field_defaults[name] else value
            for name, value in self._asdict().items()
        }

    def refuse_other(self, logs: Sequence[str]) -> None:
        """Refuse segments and payloads of logs that were not given."""
        refuse_other_segments(self.segments, logs)
        refuse_other_payloads(self.payload, logs)


READ_AS_IT_IS = LogOptions()
"""Logs without any option."""

OF_FILES = ("--names", "--format", "--passive", "--unmeasured", "--payload", "--base-position", "--wrench")
"""Options that have no effect on datasets."""


class LegOptions(NamedTuple):
    """Which leg is meant."""

    # "left", "right" or "both"
    side: Annotated[
        str | None, typer.Option(help="left, right or both, of a built-in leg; default: that of the logs.")
    ] = None
    # inertia set of a built-in leg
    inertias: Annotated[str | None, typer.Option(help="Inertia set of a built-in leg.")] = None
    # joints of a URDF that move, separated by commas
    joints: Annotated[
        str | None, typer.Option(metavar="A,B", help="Moving joints of a URDF; default: those in the logs, or all.")
    ] = None

    def find(
        self, name: str, logged: Sequence[str] | None, *, moving_base: bool = False, floating_base: bool = False
    ) -> Leg:
        """Load the leg."""
        return find_leg(
            name,
            self.side,
            self.inertias,
            split_names(self.joints),
            logged,
            moving_base=moving_base,
            floating_base=floating_base,
        )


ANY_LEG = LegOptions()
"""The default leg of a name."""


def read_logs(names: Sequence[str], options: LogOptions, joints: Sequence[str] | None = None) -> list[Recording]:
    """Read logs, or the parts of a built-in dataset."""
    recordings = []
    for name in names:
        recordings.append(read_log(name, options, joints))
        note(f"read {recordings[-1]}", Amount.VERBOSE)
    return recordings


def parse_terms(text: str | None) -> tuple[Term, ...]:
    """Turn "coulomb,viscous" into terms; None means the default, and "none" no terms."""
    if text is None:
        return DEFAULT_TERMS
    return () if text.strip() == "none" else tuple(term_by_name(name.strip()) for name in text.split(","))


def split_names(text: str | None) -> tuple[str, ...] | None:
    """Turn "hip,knee" into names."""
    return None if text is None else tuple(name.strip() for name in text.split(","))


def given_terms(text: str | None) -> tuple[Term, ...] | None:
    """Turn "coulomb,viscous" into terms; None stays None, for the default with the terms of drives."""
    return None if text is None else parse_terms(text)


def read_drives(file: str | None, leg: Leg) -> Actuators | None:
    """Read the drives of a leg; None without a file."""
    return None if file is None else read_actuators(file, leg)


def parse_numbers(text: str | None, option: str) -> tuple[float, ...] | None:
    """Turn "0.3,0.2" into numbers; one number stands for all joints."""
    if text is None:
        return None
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise ExoidError(f"{option} {text}", remedy="write numbers, separated by commas, e.g. 0.3,0.2,0.1") from None


def parse_frames(texts: Sequence[str] | None) -> dict[str, WrenchFrame]:
    """Turn "left_foot:link@0,0,-0.08" into axes and points by link."""
    frames: dict[str, WrenchFrame] = {}
    for text in texts or ():
        try:
            link, frame = frame_of_link(text)
        except ExoidError as error:
            raise ExoidError(f"--wrench {error.what}", remedy=error.remedy) from None
        if link in frames:
            raise ExoidError(f"--wrench {text}: {link} is given twice", remedy="give each link once")
        frames[link] = frame
    return frames


def read_log(name: str, options: LogOptions, joints: Sequence[str] | None = None) -> Recording:
    """Read a log, or a part of a built-in dataset; arguments as for :func:`read_logs`."""
    dataset, _, part = name.partition(":")
    if dataset not in DATASETS or is_readable(name):
        recording = _from_file(name, options, joints)
    elif part in ("train", "test"):
        recording = _from_dataset(name, options)
    else:
        raise ExoidError(f"no log {name!r}", remedy=f"name {dataset}:train or {dataset}:test")
    if options.segments is not None:
        recording = recording.segments(read_segments(Path(options.segments), name))
    if options.start is None and options.stop is None:
        return recording
    return recording.between(options.start, options.stop)


def _from_dataset(name: str, options: LogOptions) -> Recording:
    """Read a part of a dataset, which has no other columns than those of a recording."""
    refuse({"--mask": options.mask}, f"{name} has no such column")
    given = options._replace(payload=options.payload if payloads_in(name, options.payload) else None).given()
    refuse({option: given[option] for option in OF_FILES}, f"{name} is a dataset")
    dataset, _, part = name.partition(":")
    data = DATASETS[dataset]()
    return data.train if part == "train" else data.test


def _from_file(name: str, options: LogOptions, joints: Sequence[str] | None) -> Recording:
    """Read a log from a file or a bag."""
    unit: Literal["deg", "rad"] = "deg" if options.degrees else "rad"
    stamps: Literal["header", "received"] = "received" if options.received else "header"
    return Recording.from_file(
        *(name, joints, _columns(options.column)),
        angle_unit=unit,
        topic=options.topic,
        stamps=stamps,
        mask=options.mask,
        names=split_names(options.names),
        format=options.format,
        passive=split_names(options.passive) or (),
        unmeasured=split_names(options.unmeasured) or (),
        payloads=payloads_in(name, options.payload),
        base_position=parse_numbers(options.base_position, "--base-position"),
        wrench_frames=parse_frames(options.wrench),
    )


def _columns(pairs: Sequence[str] | None) -> dict[str, Column] | None:
    if not pairs:
        return None
    split = [pair.partition("=") for pair in pairs]
    for pair, (name, _, header) in zip(pairs, split, strict=True):
        if not name or not header:
            raise ExoidError(f"--column {pair}", remedy="write NAME=HEADER, e.g. --column q_hip=pos1")
    return {name.strip(): Column.from_text(header.strip()) for name, _, header in split}
