"""Size of gravity in the readings of an accelerometer: a base that walks in place is not accelerated on average."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding
from exoid.regression.rows import for_leg
from exoid.signals import BaseMotion, Poses, Recording
from exoid.signals.filters.low_pass import slow_part
from exoid.torques import TorqueModel

GRAVITY = 9.81
"""Gravity of the models [m/s²]."""

NOTICEABLE = 0.05
"""Error of the mean specific force that counts [m/s²]: it moves mass moments by 0.5 %."""

GAINED = 1.0
"""Velocity that a base may gain during a recording [m/s]."""

SLOW = 0.08
"""Frequency below which the accelerometer says how the base leans, and above which the gyroscope does [Hz]."""


def gravity_size_findings(model: TorqueModel, data: Sequence[Recording | Poses]) -> Iterator[Finding]:
    """Compare the mean vertical specific force of a base with gravity."""
    # A base that does not fly away has no mean acceleration: the mean of f · u over a recording is g, with u
    # the vertical in its axes. A bias along it scales all gravity torques, which no residual shows.
    for one in data:
        if isinstance(one, Poses) or one.base is None or one.base.pose is not None or one.contacts:
            continue
        recording = for_leg(model, one)
        assert recording.base is not None
        size = _mean_vertical_force(recording.base, recording.sample_rate)
        error = size - GRAVITY
        limit = NOTICEABLE + GAINED / recording.duration
        if abs(error) > limit:
            yield Finding(
                "gravity-size",
                "",
                error,
                "m/s²",
                "warning",
                f"the accelerometer of the base reads {size:.4g} m/s² upwards on average, and not {GRAVITY}: "
                f"it is off, which changes mass moments by {100.0 * error / GRAVITY:.2g} %",
                "calibrate it (rest it on each side), or record when a foot is flat on the ground (contacts=), which "
                "finds its bias",
                parameters=model.leg.parameter_names,
                recording=one.source.name if one.source else "",
            )


def _mean_vertical_force(base: BaseMotion, rate: float) -> float:
    """Mean of the specific force along the vertical [m/s²]."""
    # The base leans by φ about the axis a that it turns about most, and by a small angle across. The vertical is then
    # u = cos φ m + sin φ (a × m) with the mean direction m of the force, and φ̇ = −a · ω.
    force, omega = base.specific_force, base.angular_velocity
    middle = force.mean(axis=0) / np.linalg.norm(force.mean(axis=0))
    level = omega - np.outer(omega @ middle, middle)
    axis = np.linalg.eigh(np.cov(level.T))[1][:, -1]
    axis = axis - (axis @ middle) * middle
    axis = axis / np.linalg.norm(axis)
    side = np.cross(axis, middle)
    upward, aside, across = force @ middle, force @ side, force @ axis
    lean = _lean(np.arctan2(aside, upward), -omega @ axis, rate)
    other = _lean(np.arctan2(across, upward), omega @ side, rate)
    return float(np.mean(upward * np.cos(lean) + aside * np.sin(lean)) * (1.0 + 0.5 * np.mean(other**2)))


def _lean(slow: FloatArray, turning: FloatArray, rate: float) -> FloatArray:
    """Join the slow part of angles that an accelerometer says, and the fast part of those that a gyroscope says."""
    apart = np.cumsum(turning) / rate - slow
    return np.asarray(slow + apart - slow_part(apart, rate, min(SLOW, 0.08 * rate)))
