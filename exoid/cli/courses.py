"""Motions that ``exoid track`` and ``exoid export --law`` follow: a gait, or a log."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
import typer

from exoid import experiments
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.rig import Reference

from .inputs import LogOptions, read_log

HARMONICS = 6
"""Number of harmonics fitted to a reference from a log of a periodic motion."""

LARGEST_DEVIATION = np.deg2rad(1.0)
"""Largest deviation (RMS) of these harmonics from the log [rad]."""

SETTLE, SETTLED_SHARE = 1.0, 0.25
"""Time at the beginning of a log that the metrics leave out [s], and its largest share of the log."""

SCALE = 0.8
"""Factor of the gait's amplitudes on legs other than document 2's: within the limits of both built-in ones."""


class MotionOptions(NamedTuple):
    """The motion to follow; None for the default of each."""

    period: Annotated[
        float | None,
        typer.Option(metavar="S", help="Period of the gait; default 10. With --reference: that of a periodic log."),
    ] = None
    scale: Annotated[float | None, typer.Option(help="Factor of the gait's amplitudes; default 0.8.")] = None
    speed: Annotated[str | None, typer.Option(help="Norm of VerySlow, Slow, Free or Fast gait.")] = None
    reference: Annotated[
        str | None, typer.Option(metavar="LOG", help="Follow the angles of a log from its beginning to its end.")
    ] = None
    role: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=ROLE", help="Joint that is the hip, knee or ankle of the gait. Repeatable."),
    ] = None


class Course(NamedTuple):
    """Reference, its period or duration [s], and the time that the metrics leave out [s]; None for one period."""

    reference: Reference
    period: float
    settle: float | None = None


def gait(leg: Leg, options: MotionOptions) -> Course:
    """Make a gait for a leg."""
    period = 10.0 if options.period is None else options.period
    if not 0.0 < period < np.inf:
        raise ExoidError(f"--period {period:g}", remedy="give seconds")
    scale = SCALE if options.scale is None else options.scale
    norm = (
        experiments.healthy_gait(scale, period)
        if options.speed is None
        else experiments.norm_gait(options.speed, scale, period)
    )
    return Course(experiments.gait_for_leg(leg, norm, roles_of(options.role)), period)


def logged(leg: Leg, name: str, period: float | None, reading: LogOptions) -> Course:
    """Follow a log; one of a periodic motion, again and again."""
    log = read_log(name, reading, leg.joint_names)
    if period is None:
        followed = experiments.follow_log(log)
        return Course(followed, followed.duration, min(SETTLE, SETTLED_SHARE * followed.duration))
    time = log.time - log.time[0]
    periodic = experiments.fit_harmonics(time, log.q, period, HARMONICS)
    deviation = log.q - np.array([periodic.at(float(t)).q[:, 0] for t in time])
    worst = float(np.sqrt(np.mean(deviation**2, axis=0)).max())
    if worst > LARGEST_DEVIATION:
        raise ExoidError(
            f"{HARMONICS} harmonics of a period of {period:g} s deviate from the log by {np.rad2deg(worst):.1f}° (RMS)",
            where=name,
            remedy="leave out --period to follow the log itself",
        )
    return Course(periodic, period)


def roles_of(pairs: list[str] | None) -> dict[str, str]:
    """Turn "HFE=hip" into a role by joint."""
    roles = {}
    for pair in pairs or ():
        joint, _, role = pair.partition("=")
        if not joint or not role:
            raise ExoidError(f"--role {pair}", remedy="write JOINT=ROLE, e.g. --role HFE=hip --role KFE=knee")
        roles[joint.strip()] = role.strip()
    return roles
