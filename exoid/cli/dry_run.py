"""``exoid track EST.JSON --dry-run LOG``: the torque that a controller would have commanded during a log."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid import control
from exoid.control import LawReplay, Limited
from exoid.control.model import ModelSource
from exoid.control.stateful import AnyLaw
from exoid.errors import ExoidError
from exoid.experiments import follow_log
from exoid.signals import Recording

from .inputs import LogOptions, read_log
from .numbers import joint_values

WITHOUT_TARGET = ("gravity_support", "transparent")
"""Controllers for wearers, which follow no reference."""


class DryRun(NamedTuple):
    """Options of a dry run; None for the default of each."""

    log: str  # log to replay
    law: str | None  # name of the controller
    kp: str | None  # stiffness of each joint
    kd: str | None  # damping of each joint
    rate: float | None  # rate of the controller [Hz]; that of the log if it is lower than 100 Hz
    limit: str | None  # largest torque of each joint
    slew: str | None  # largest rate of change of the torque of each joint


def dry_run(source: ModelSource, options: DryRun, reading: LogOptions) -> LawReplay:
    """Replay a controller on a log.

    Args:
        source: Source of the controller's model.
        options: Options.
        reading: How to read the log.

    Returns:
        Commanded and recorded torque.

    Raises:
        ExoidError: A name, a number or the log is not usable.
    """
    leg = control.ControlModel.of(source).leg
    recording = read_log(options.log, reading, leg.joint_names)
    rate = min(100.0, recording.sample_rate) if options.rate is None else options.rate
    name = WITHOUT_TARGET[0] if options.law is None else options.law
    law = _law(name, source, recording, options, rate)
    if options.limit is not None or options.slew is not None:
        limits = [
            np.inf if text is None else joint_values(text, option, leg.joint_labels, one_for_all=True)
            for text, option in ((options.limit, "--limit"), (options.slew, "--slew"))
        ]
        law = Limited(law, *limits)
    return control.replay_law(law, recording, name=name)


def _law(name: str, source: ModelSource, recording: Recording, options: DryRun, rate: float) -> AnyLaw:
    """Make a controller by its name."""
    if name in WITHOUT_TARGET:
        if options.kp is not None or options.kd is not None:
            raise ExoidError(f"{name} has no gains", remedy="leave out --kp and --kd")
        make = control.gravity_support if name == "gravity_support" else control.transparent
        return make(source, rate=rate)
    if name not in control.LAWS:
        raise ExoidError(f"no controller {name!r}", remedy=f"use one of {', '.join((*WITHOUT_TARGET, *control.LAWS))}")
    followed = follow_log(recording)
    labels = control.ControlModel.of(source).leg.joint_labels
    kp, kd = control.default_gains(source, control.mean_pose(followed, followed.duration))
    if options.kp is not None:
        kp = joint_values(options.kp, "--kp", labels, one_for_all=True)
        kd = 0.1 * kp
    if options.kd is not None:
        kd = joint_values(options.kd, "--kd", labels, one_for_all=True)
    return control.standard_laws(source, kp, kd, followed, followed.duration, rate=rate, names=(name,))[name]
