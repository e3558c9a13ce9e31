"""``exoid track EST.JSON --dry-run LOG``: the torque that a controller would have commanded during a log."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from exoid import control
from exoid.control import LawReplay, Limited
from exoid.errors import BadArgumentError, nearest
from exoid.experiments import follow_log

from .inputs import read_log_of
from .numbers import joint_values, parse_gains
from .options import DryRunOptions, GainOptions, LogOptions
from .refusals import refuse

if TYPE_CHECKING:
    from exoid.control.law import AnyLaw
    from exoid.estimate import Estimate
    from exoid.rig import Plant
    from exoid.signals import Recording

WITHOUT_TARGET = ("gravity_support", "transparent")
"""Controllers for wearers, which follow no reference."""


def dry_run(source: Estimate | Plant, options: DryRunOptions, gains: GainOptions, reading: LogOptions) -> LawReplay:
    """Replay a controller on a log; its rate is at most that of the log."""
    recording = read_log_of(source.leg, str(options.dry_run), reading)
    rate = min(100.0, recording.sample_rate) if gains.rate is None else gains.rate
    name = WITHOUT_TARGET[0] if options.law is None else options.law
    law = _law(name, source, recording, gains, rate)
    if options.limit is not None or options.slew is not None:
        limits = [
            np.inf if text is None else joint_values(text, option, source.leg.joint_labels)
            for text, option in ((options.limit, "--limit"), (options.slew, "--slew"))
        ]
        law = Limited(law, *limits)
    return control.replay_law(law, recording, name=name)


def _law(name: str, source: Estimate | Plant, recording: Recording, gains: GainOptions, rate: float) -> AnyLaw:
    """Make a controller by its name."""
    if name in (*WITHOUT_TARGET, "lqr"):
        refuse({"--kp": gains.kp, "--kd": gains.kd}, f"{name} has no gains")
    if name in WITHOUT_TARGET:
        friction = control.PASSIVE if name == "transparent" else None
        return control.gravity_support(source, friction=friction, rate=rate)
    known = (*WITHOUT_TARGET, *control.LAWS)
    if name not in known:
        raise BadArgumentError(f"no controller {name!r}", remedy=f"{nearest(name, known)}use one of {', '.join(known)}")
    followed = follow_log(recording)
    usual = control.default_gains(source, control.mean_pose(followed, followed.duration), rate)
    kp, kd = parse_gains(gains.kp, gains.kd, source.leg.joint_labels, usual)
    return control.standard_laws(source, kp, kd, followed, followed.duration, rate=rate, names=(name,))[name]
