"""Motions that ``exoid track`` and ``exoid export --law`` follow: a gait, or a log."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

import exoid
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.experiments.gait import fit_to_limits

from .inputs import read_log_of
from .messages import note
from .numbers import parse_roles
from .options import LogOptions

if TYPE_CHECKING:
    from exoid.leg.leg import Leg
    from exoid.rig import Reference

SCALE = 0.8
"""Factor of the gait's amplitudes on legs other than document 2's: within the limits of both built-in ones."""


class Motion(NamedTuple):
    """Reference, its period or duration [s], and the time that the metrics leave out [s]; None for one period."""

    reference: Reference
    period: float
    settle: float | None = None


def gait(leg: Leg, period: float | None, scale: float | None, roles: Sequence[str] | None) -> Motion:
    """Make the gait of a healthy person for a leg."""
    period = 10.0 if period is None else period
    if not 0.0 < period < np.inf:
        raise BadArgumentError(f"--period {period:g}", remedy="give seconds")
    healthy = exoid.experiments.healthy_gait(SCALE if scale is None else scale, period)
    motion = exoid.experiments.gait_for_leg(leg, healthy, parse_roles(roles))
    if scale is not None:  # what was asked for is refused where it does not fit
        return Motion(motion, period)
    fitted = fit_to_limits(leg, motion)
    changed = np.any((fitted.centre != motion.centre) | (fitted.amplitude != motion.amplitude), axis=(0, 2))
    for joint in np.array(leg.joint_names)[changed]:
        note(f"the gait of {joint} leaves the joint's limits: it was fitted into them (--scale keeps its form)")
    return Motion(fitted, period)


def gait_or_rest(leg: Leg, roles: Sequence[str] | None) -> Motion:
    """Make the usual gait, or rest at the zero pose for a leg without a gait: default gains need a pose only."""
    try:
        return gait(leg, None, None, roles)
    except NotSupportedError:
        if roles:
            raise
        return Motion(exoid.experiments.Hold(np.zeros((len(leg.joint_names), 1))), 10.0)


def logged(leg: Leg, name: str, reading: LogOptions) -> Motion:
    """Follow a log."""
    followed = exoid.experiments.follow_log(read_log_of(leg, name, reading))
    return Motion(followed, followed.duration, min(1.0, 0.25 * followed.duration))
