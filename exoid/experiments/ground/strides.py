"""Strides of a walking machine: flexion of hip, knee and ankle."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.experiments.fourier import fit_harmonics
from exoid.experiments.gait import gait_for_leg, healthy_gait, norm_gait
from exoid.experiments.references import Harmonics
from exoid.leg.leg import Leg

from .posture import PlanarLeg
from .waves import rise

TILT_DEG = np.array(
    [
        (0.0, 14.0),
        (0.08, 0.0),
        (0.36, 0.0),
        (0.5, -20.0),
        (0.6, -60.0),
        (0.66, -66.0),
        (0.75, -45.0),
        (0.85, -10.0),
        (0.95, 14.0),
        (1.0, 14.0),
    ]
)
"""Phase of the stride and angle of the sole to the ground [deg], an assumption: heel strike, flat, toe-off, swing."""


def stride(speed: str | None, scale: float, period: float) -> Harmonics:
    """Make the flexion of hip, knee and ankle."""
    if speed is not None:
        return norm_gait(speed, scale, period)
    published, phase = healthy_gait(scale, period), np.linspace(0.0, 1.0, 400, endpoint=False)
    hip, knee = np.array([published.at(p * period).q[:, 0] for p in phase]).T
    knee = knee + np.deg2rad(5.0)  # the knee of the published stride is straight at heel contact
    tilt = scipy.interpolate.PchipInterpolator(*TILT_DEG.T)(phase)
    ankle = np.deg2rad(scale * tilt) - hip + knee
    return fit_harmonics(period * phase, np.column_stack([hip, knee, ankle]), period, 8)


def walking_angles(
    machine: Leg, legs: tuple[PlanarLeg, ...], time: FloatArray, flexion: Harmonics, period: float
) -> FloatArray:
    """Let all legs follow a stride, evenly apart, that grows from its mean posture."""
    q = np.zeros((len(time), len(machine.joint_names)))
    for number, leg in enumerate(legs):
        own = Leg.from_description(machine.description, machine.joint_names[leg.joints])
        motion = gait_for_leg(own, flexion, dict(zip(own.joint_names, ("hip", "knee", "ankle"), strict=True)))
        argument = motion.frequency * (time + number / len(legs) * period)[:, None, None, None] + motion.phase
        swing = (motion.amplitude * np.sin(argument)).sum(axis=1)
        q[:, leg.joints] = (motion.centre + rise(time)[:, None, None] * swing)[..., 0]
    return q
