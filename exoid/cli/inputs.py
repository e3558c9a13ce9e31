"""Arguments of the command line: legs, logs and terms."""

from __future__ import annotations

import csv
import os
import stat
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import pinocchio as pin
import typer

from exoid import datasets
from exoid.actuators import Actuators, read_actuators
from exoid.catalog import SEGMENTS, load_exo, load_leg
from exoid.description import read_description
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.leg_data import Base
from exoid.signals import Column, Recording, WrenchFrame
from exoid.signals.wrench_frame import frame_of_link
from exoid.torques import DEFAULT_TERMS, Term, term_by_name

from .messages import Amount, note
from .payloads import payloads_in
from .robots import how_to_name_one, is_robot, urdf_of_robot

DATASETS: Mapping[str, Callable[[], datasets.Dataset]] = {
    "bleex_swing": datasets.bleex_swing,
    "dfki_double_pendulum": datasets.dfki_double_pendulum,
    "sydney_swing_leg": datasets.sydney_swing_leg,
    "sydney_swing_leg_outer": partial(datasets.sydney_swing_leg, "outer"),
    "teststand_leg": datasets.teststand_leg,
}
"""Datasets of exoid, as LEG ``name`` and LOG ``name:train`` or ``name:test``."""

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
    """How to read logs.

    Attributes:
        columns: "NAME=HEADER" pairs.
        degrees: Whether angles are degrees.
        start: First time stamp to use [s].
        stop: First time stamp not to use [s].
        topic: Topic of joint states in bags; None for the only one.
        received: Whether the time in bags is that at which they received the messages.
        segments: CSV file of the segments that count; None for all.
        mask: Header of a column of 0 and 1 that says which samples count; None for all.
        names: Names of the columns of files without a header line, separated by commas.
        passive: Joints without an actuator, separated by commas.
        unmeasured: Joints whose torque column is not read, separated by commas.
        payloads: "LOG=SEGMENT:KG@X,Y,Z" of payloads.
        base_position: Position of the sensor on the base [m], "X,Y,Z".
        wrenches: "LINK:AXES@X,Y,Z" of wrenches.
        format: "NAME:JOINT" of the log of an actuator.
    """

    columns: Sequence[str] | None = None
    degrees: bool = False
    start: float | None = None
    stop: float | None = None
    topic: str | None = None
    received: bool = False
    segments: str | None = None
    mask: str | None = None
    names: str | None = None
    passive: str | None = None
    unmeasured: str | None = None
    payloads: Sequence[str] | None = None
    base_position: str | None = None
    wrenches: Sequence[str] | None = None
    format: str | None = None


def read_logs(names: Sequence[str], options: LogOptions, joints: Sequence[str] | None = None) -> list[Recording]:
    """Read logs, or the parts of a built-in dataset.

    Args:
        names: Paths, or ``dataset:train`` and ``dataset:test``.
        options: How to read files.
        joints: Requested joints; None for all in the file.

    Returns:
        One recording for each name.
    """
    recordings = []
    for name in names:
        recordings.append(read_log(name, options, joints))
        note(f"read {recordings[-1]}", Amount.VERBOSE)
    return recordings


def find_leg(
    name: str,
    side: str | None,
    inertias: str | None,
    joints: Sequence[str] | None,
    logged: Sequence[str] | None,
    *,
    moving_base: bool = False,
    floating_base: bool = False,
) -> Leg:
    """Load a leg: a built-in one, that of a dataset, of a URDF file, or a robot of example-robot-data.

    Args:
        name: Name of a leg, dataset or robot, or path of a URDF.
        side: "left", "right" or "both" for a built-in leg; None for the side whose joints were logged, and for both if
            the base floats.
        inertias: Inertia set of a built-in leg.
        joints: Joints of a URDF that move; None for those that were logged.
        logged: Joints in the log; None without a log: all joints of a URDF move.
        moving_base: Whether the leg has the parameters of a base that moves in space.
        floating_base: Whether it has rows of a base that floats.

    Returns:
        The leg.

    Raises:
        ExoidError: There is no such leg or file, or an option has no effect on it.
    """
    if name in SEGMENTS or name in DATASETS:
        refuse({"--moving-base": moving_base or None}, f"{name} is planar; name a URDF file for a base in space")
    if name in SEGMENTS:
        refuse({"--joints": joints}, f"the joints of {name} are known")
        base: Base = "floating" if floating_base else "fixed"
        if side == "both" or (floating_base and side is None):
            return load_exo(name, inertias, base=base)
        return load_leg(name, side or _side(logged or ()), inertias, base=base)
    refuse({"--side": side, "--inertias": inertias}, f"{name!r} is no built-in leg")
    if name in DATASETS:
        refuse({"--joints": joints}, f"the joints of {name} are known")
        refuse({"--floating-base": floating_base or None}, f"the base of {name} was held")
        return DATASETS[name]().leg
    refuse_unknown_leg(name)
    if not is_readable(name):
        name = str(urdf_of_robot(name))
    if joints is None and logged is not None:
        joints = _moving_joints(Path(name), logged)
    if moving_base:
        refuse({"--floating-base": floating_base or None}, "--moving-base is for rows of joints only")
        return Leg.from_urdf(name, joints, base="moving")
    return Leg.from_urdf(name, joints, base="floating" if floating_base else "fixed")


def refuse_unknown_leg(name: str) -> None:
    """Refuse what is neither a leg nor a file, before logs are read whose columns would be blamed.

    Args:
        name: Name of a leg or dataset, or path of a URDF.

    Raises:
        ExoidError: There is no such leg or file; names files that are similar.
    """
    if name in SEGMENTS or name in DATASETS or is_readable(name) or is_robot(name):
        return
    if os.path.isdir(name):  # noqa: PTH112 - as in is_readable
        raise ExoidError("is a folder, not a URDF file", where=name, remedy="name the URDF file in it")
    known = ", ".join([*SEGMENTS, *DATASETS])
    similar = get_close_matches(Path(name).name, _names_beside(Path(name)), n=3, cutoff=0.6)
    beside = f"; there is {', '.join(similar)}" if similar else ""
    remedy = f"name a built-in leg ({known}), a URDF file, or {how_to_name_one()}"
    raise ExoidError(f"no leg or URDF file {name!r}{beside}", remedy=remedy)


def is_readable(name: str) -> bool:
    """Tell whether a name is that of a file.

    Args:
        name: Path of a file, or another name.

    Returns:
        Whether there is such a file.

    Raises:
        ExoidError: A folder on the way to it cannot be read.
    """
    try:
        return stat.S_ISREG(Path(name).stat().st_mode)
    except (FileNotFoundError, NotADirectoryError, ValueError):
        return False
    except OSError as problem:
        raise unreadable(name, problem) from None


def unreadable(name: str, problem: Exception) -> ExoidError:
    """Make the error about a file that the system does not let read.

    Args:
        name: Path of the file.
        problem: Error of the system.

    Returns:
        The error.
    """
    reason = getattr(problem, "strerror", None) or str(problem)
    return ExoidError(f"cannot be read ({reason})", where=name, remedy="check the path and its rights")


def _names_beside(path: Path) -> list[str]:
    try:
        return [each.name for each in path.parent.iterdir()]
    except (OSError, ValueError):
        return []


def refuse(options: Mapping[str, object], why: str) -> None:
    """Refuse options that have no effect.

    Args:
        options: Values by option; None for an option that was not given.
        why: Reason, for the message.

    Raises:
        ExoidError: An option was given.
    """
    for option, value in options.items():
        if value is not None:
            raise ExoidError(f"{option} has no effect: {why}", remedy=f"leave out {option}")


def _side(logged: Sequence[str]) -> str:
    """Side of the logged joints; left if their names have none."""
    sides = [side for side in ("left", "right") if any(joint.startswith(f"{side}_") for joint in logged)]
    if len(sides) > 1:
        raise ExoidError(
            "the log has joints of both sides", remedy="choose with --side left, --side right or --side both"
        )
    return sides[0] if sides else "left"


def _moving_joints(urdf: Path, logged: Sequence[str]) -> tuple[str, ...]:
    """Logged joints of a URDF, from the base outwards."""
    joints = _joint_order(urdf)
    if not joints:
        raise ExoidError("no joint of the URDF moves", where=str(urdf), remedy="give joints a type such as revolute")
    moving = tuple(joint for joint in joints if joint in logged)
    if not moving:
        raise ExoidError(
            f"none of the logged joints ({', '.join(logged)}) is in the URDF ({', '.join(joints)})",
            where=str(urdf),
            remedy=f"map the log's columns, e.g. --column q_{joints[0]}=HEADER --column tau_{joints[0]}=HEADER",
        )
    return moving


def _joint_order(urdf: Path) -> tuple[str, ...]:
    """All joints of a URDF in Pinocchio's order, without the reduction, which takes seconds for a humanoid."""
    try:
        return tuple(pin.buildModelFromXML(read_description(urdf).text).names)[1:]
    except Exception:  # any error of Pinocchio's parser: the leg has a better message
        return Leg.from_urdf(urdf).joint_names


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
    """Turn "0.3,0.2" into numbers; one number stands for all joints.

    Args:
        text: Numbers, separated by commas; None if the option was not given.
        option: Option, for the message.

    Returns:
        The numbers; None for None.

    Raises:
        ExoidError: A part is no number.
    """
    if text is None:
        return None
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise ExoidError(f"{option} {text}", remedy="write numbers, separated by commas, e.g. 0.3,0.2,0.1") from None


def parse_frames(texts: Sequence[str] | None) -> dict[str, WrenchFrame]:
    """Turn "left_foot:link@0,0,-0.08" into axes and points by link.

    Args:
        texts: Values of ``--wrench``.

    Returns:
        The frames.

    Raises:
        ExoidError: A text has another form, or a link occurs twice.
    """
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
    if dataset in DATASETS and part in ("train", "test") and not is_readable(name):
        refuse({"--mask": options.mask}, f"{name} has no such column")
        without_effect: dict[str, object] = {
            "--names": options.names,
            "--format": options.format,
            "--passive": options.passive,
            "--unmeasured": options.unmeasured,
            "--payload": payloads_in(name, options.payloads),
            "--base-position": options.base_position,
            "--wrench": options.wrenches,
        }
        refuse(without_effect, f"{name} is a dataset")
        data = DATASETS[dataset]()
        recording = data.train if part == "train" else data.test
    elif dataset in DATASETS and not is_readable(name):
        raise ExoidError(f"no log {name!r}", remedy=f"name {dataset}:train or {dataset}:test")
    else:
        unit: Literal["deg", "rad"] = "deg" if options.degrees else "rad"
        stamps: Literal["header", "received"] = "received" if options.received else "header"
        recording = Recording.from_file(
            *(name, joints, _columns(options.columns)),
            angle_unit=unit,
            topic=options.topic,
            stamps=stamps,
            mask=options.mask,
            names=split_names(options.names),
            format=options.format,
            passive=split_names(options.passive) or (),
            unmeasured=split_names(options.unmeasured) or (),
            payloads=payloads_in(name, options.payloads),
            base_position=parse_numbers(options.base_position, "--base-position"),
            wrench_frames=parse_frames(options.wrenches),
        )
    if options.segments is not None:
        recording = recording.segments(read_segments(Path(options.segments), name))
    if options.start is None and options.stop is None:
        return recording
    return recording.between(options.start, options.stop)


def read_segments(path: Path, log: str) -> list[tuple[float, float]]:
    """Read the segments of a log that count.

    Args:
        path: CSV file with columns start and stop [s], and ``log``, the file name, if there are several logs.
        log: Name or path of the log.

    Returns:
        Start and stop of each segment of this log [s].

    Raises:
        ExoidError: The file cannot be read, a column is missing, a cell is no number, or the log has no segment.
    """
    found = [pair for name, pair in _segment_lines(path) if name is None or name in (log, Path(log).name)]
    if not found:
        raise ExoidError(f"no segments of {log}", where=str(path), remedy="name it in the column log")
    return found


def refuse_other_segments(file: str | None, logs: Sequence[str]) -> None:
    """Refuse segments that do not say which of several logs they belong to, or name a log that was not given.

    Args:
        file: CSV file of the segments; None for none.
        logs: Names or paths of all logs that are read.

    Raises:
        ExoidError: See above, or the file cannot be read.
    """
    if file is None:
        return
    path = Path(file)
    named = {name for name, _ in _segment_lines(path)}
    if None in named and len(logs) > 1:
        raise ExoidError("segments do not say which log they belong to", where=f"{path}", remedy="add a column log")
    for name in sorted(named - {None} - set(logs) - {Path(log).name for log in logs}, key=str):
        raise ExoidError(f"segments of {name}, which is not among the logs", where=str(path), remedy="check its name")


def _segment_lines(path: Path) -> list[tuple[str | None, tuple[float, float]]]:
    """Name of the log, where there is one, with start and stop of each segment."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file, skipinitialspace=True))
    except (OSError, ValueError, csv.Error) as error:
        raise unreadable(str(path), error) from None
    lines = []
    for number, row in enumerate(rows, start=2):
        try:
            lines.append((row.get("log") or None, (float(row["start"]), float(row["stop"]))))
        except (KeyError, TypeError, ValueError):
            raise ExoidError(
                "a line without start and stop",
                where=f"{path}, line {number}",
                remedy="write a header start,stop and two numbers a line [s]",
            ) from None
    if not lines:
        raise ExoidError("there are no segments", where=str(path), remedy="write start,stop and two numbers a line [s]")
    return lines


def _columns(pairs: Sequence[str] | None) -> dict[str, Column] | None:
    if not pairs:
        return None
    split = [pair.partition("=") for pair in pairs]
    for pair, (name, _, header) in zip(pairs, split, strict=True):
        if not name or not header:
            raise ExoidError(f"--column {pair}", remedy="write NAME=HEADER, e.g. --column q_hip=pos1")
    return {name.strip(): Column.from_text(header.strip()) for name, _, header in split}
