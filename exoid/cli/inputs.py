"""What verbs read: logs, terms and drives."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import exoid
from exoid.errors import BadArgumentError, ExoidError, in_file, nearest

from .legs import DATASETS, dataset
from .messages import note
from .numbers import parse_numbers, split_names, values_by_name
from .options import LogOptions, given
from .refusals import is_readable, refuse, refuse_form

if TYPE_CHECKING:
    from exoid.actuators import Actuators
    from exoid.leg.leg import Leg
    from exoid.leg.payload import Payload
    from exoid.signals import Recording, WrenchFrame
    from exoid.torques import Term


def read_logs(names: Sequence[str], options: LogOptions, *, beside: Sequence[str] = ()) -> list[Recording]:
    """Read logs, or the parts of a built-in dataset; payloads may also name those ``beside``."""
    refuse_other_payloads(options, [*names, *beside])
    return [read_log(name, options) for name in names]


def read_log(name: str, options: LogOptions, joints: Sequence[str] | None = None) -> Recording:
    """Read a log, or a part of a built-in dataset."""
    base, _, part = name.partition(":")
    if base not in DATASETS or is_readable(name):
        recording = _from_file(name, options, joints)
    elif part in ("train", "test"):
        refuse({"--mask": options.mask}, f"{name} has no such column")
        wanted = given(options._replace(payload=options.payload if _payloads_of(options.payload, name) else None))
        of_files = ("--passive", "--unmeasured", "--payload", "--base-position", "--wrench", "--late")
        refuse({option: wanted[option] for option in of_files}, f"{name} is a dataset")
        recording = dataset(base).train if part == "train" else dataset(base).test
    else:
        raise BadArgumentError(f"no log {name!r}", remedy=f"name {base}:train or {base}:test")
    if options.start is None and options.stop is None:
        return recording
    return recording.between(options.start, options.stop)


def load_estimate(path: str) -> exoid.Estimate:
    """Load an estimate, and repeat its errors: what is made of it has them, too."""
    found = exoid.Estimate.load(path)
    for finding in found.findings:
        if finding.severity == "error":
            note(f"{path}: {finding}")
    return found


def read_log_of(leg: Leg, name: str, options: LogOptions) -> Recording:
    """Read a log of the joints of a leg, whose columns have their names or their labels."""
    try:
        return read_log(name, options, leg.joint_names)
    except ExoidError as error:
        if error.column[:2] not in ("q_", "") or leg.joint_labels == leg.joint_names:  # none: options name joints, too
            raise
        try:
            log = read_log(name, options, leg.joint_labels)
        except ExoidError:
            raise error from None
        passive = tuple(leg.joint_names[log.joint_names.index(joint)] for joint in log.passive)
        return replace(log, joint_names=leg.joint_names, passive=passive)


def _from_file(name: str, options: LogOptions, joints: Sequence[str] | None) -> Recording:
    """Read a log from a file or a bag."""
    refuse_form(name, "LOG")
    example = "NAME=HEADER, e.g. --column q_hip=pos1"
    columns = values_by_name(options.column, "--column", exoid.signals.Column.from_text, example)
    plates = values_by_name(options.plate, "--plate", str, "PLATE=LINK, e.g. --plate 1=right_foot")
    if options.forces is not None and not plates:
        known = ", ".join(exoid.signals.read_opensim_forces(options.forces).wrenches)
        remedy = f"give --plate PLATE=LINK; its plates are {known}"
        raise BadArgumentError("nobody says which link stands on which plate", where=options.forces, remedy=remedy)
    recording = exoid.signals.read_opensim(
        *(name, columns or None),
        joint_names=joints,
        forces=options.forces,
        links=plates if options.forces is not None else None,
        beside=options.with_ or (),
        angle_unit="deg" if options.degrees else "rad",
        largest_angle=math.inf if options.degrees is False else 2.0 * math.pi,
        topic=options.topic,
        stamps="received" if options.received else "header",
        mask=options.mask,
        gaps=options.gaps,
        passive=split_names(options.passive) or (),
        unmeasured=split_names(options.unmeasured) or (),
        payloads=_payloads_of(options.payload, name),
        base_position=parse_numbers(options.base_position, "--base-position"),
        wrench_frames=_wrench_frames(options.wrench),
    )
    return _on_time(recording, delays_of(options))


def refuse_other_payloads(options: LogOptions, logs: Sequence[str]) -> None:
    """Refuse payloads of logs that were not given."""
    known = {name for log in logs for name in (log, Path(log).name)}
    for option in options.payload or ():
        name, found, _ = option.rpartition("=")
        if found and name not in known:
            raise BadArgumentError(f"--payload {option}: {name} is not among the logs", remedy="check its name")


def _payloads_of(options: Sequence[str] | None, log: str) -> tuple[Payload, ...] | None:
    """Find the payloads of a log, such as "heavy.csv=shank:3.0@0,0,-0.3" or one without a log."""
    from exoid.leg.payload import FORM, Payload  # noqa: PLC0415 - help needs no payloads

    payloads = []
    for option in options or ():
        name, found, text = option.rpartition("=")
        if found and name not in (log, Path(log).name):
            continue
        try:
            payloads.append(Payload.from_text(text))
        except ExoidError as error:
            what, remedy = f"--payload {option}: {error.what}", error.remedy or f"write {FORM}"
            raise BadArgumentError(what, remedy=remedy) from None
    return tuple(payloads) or None


def _wrench_frames(texts: Sequence[str] | None) -> dict[str, WrenchFrame]:
    """Turn "left_foot:link@0,0,-0.08" into axes and points by link."""
    from exoid.signals.wrench import frame_of_link  # noqa: PLC0415

    frames: dict[str, WrenchFrame] = {}
    for text in texts or ():
        try:
            link, frame = frame_of_link(text)
        except ExoidError as error:
            raise BadArgumentError(f"--wrench {error.what}", remedy=error.remedy) from None
        if link in frames:
            raise BadArgumentError(f"--wrench {text}: {link} is given twice", remedy="give each link once")
        frames[link] = frame
    return frames


def given_terms(text: str | None) -> tuple[Term, ...] | None:
    """Turn "coulomb,viscous" into terms; "none" into no terms; None stays None."""
    from exoid.torques.catalog import TERMS  # noqa: PLC0415

    if text is None:
        return None
    return () if text.strip() == "none" else tuple(TERMS.default(name.strip()) for name in text.split(","))


def read_drives(options: LogOptions, leg: Leg) -> Actuators | None:
    """Read the drives of a leg; None where no file has them."""
    from exoid.actuators.drive_data import actuators_from_data  # noqa: PLC0415 - help needs no drives

    if options.actuators is None:
        return None
    with in_file(options.actuators):
        return actuators_from_data(drive_tables(options.actuators), leg)


def drive_tables(file: str) -> Mapping[str, Any]:
    """Read the tables of drives: of a file, or as an estimate remembers them."""
    from exoid.actuators.file import read_drive_tables  # noqa: PLC0415 - see above

    if not file.endswith(".json"):
        return read_drive_tables(file)
    if "actuators" not in (known := exoid.Estimate.load(file).columns):
        raise BadArgumentError("remembers no drives", file=file, remedy="give a file of drives, such as drives.toml")
    return dict(known["actuators"])


def delays_of(options: LogOptions) -> dict[str, float]:
    """Time by which the drive of a joint is logged late, by joint [s]."""
    return values_by_name(options.late, "--late", float, "JOINT=S, e.g. --late knee=0.02")


def _on_time(recording: Recording, delays: Mapping[str, float]) -> Recording:
    """Take out the time by which drives are logged late."""
    names = recording.joint_names
    for joint, delay in delays.items():
        if joint not in names:
            remedy = f"{nearest(joint, names)}its joints are {', '.join(names)}"
            raise BadArgumentError(f"--late {joint}={delay:g}: the log has no such joint", remedy=remedy)
        if not abs(delay) <= 1.0:  # beyond it is taken for milliseconds
            raise BadArgumentError(f"--late {joint}={delay:g}: over 1 s", remedy="give seconds: 0.02 for 20 ms")
    by_joint = {names.index(joint): delay for joint, delay in delays.items()}
    return exoid.signals.without_torque_delay(recording, by_joint, readings=True) if delays else recording
