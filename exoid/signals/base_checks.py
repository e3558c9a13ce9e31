"""Checks of a base motion: units of its sensors, and whether gyroscope and accelerometer have the same axes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.torso import TorsoMotion

from . import checks
from .base_motion import BASE_COLUMNS, BaseMotion
from .base_pose import BasePose, refuse_jumps

STANDARD_GRAVITY = 9.81
"""Gravity [m/s²]."""

LIKELY = 0.6, 1.6
"""Median specific force of a base, over gravity."""

UPSIDE_DOWN = -0.5
"""Cosine of the mean lean beyond which a base hangs upside down."""

FASTEST_MEAN = 15.0
"""Largest plausible angular velocity of a base, root mean square [rad/s]."""

RATE = 25.0
"""Rate at which the direction of gravity is followed [Hz]."""

WINDOW, PASSES = 1.0, 3
"""Length [s] and number of moving averages: they keep what is slower than 0.3 Hz, where gravity outweighs motion.

At 1 Hz, a base that turns about a point 0.25 m above its sensor accelerates it against gravity's turn, and as much.
"""

SHORTEST = 10.0
"""Least length of a log that is compared [s]."""

CONCLUSIVE = 0.7
"""Least share of the power of the direction's rate that a coefficient explains, before it counts."""

SMALLEST_FORCE = 1e-6
"""Specific force below which it has no direction [m/s²]."""

DEGREES = np.pi / 180.0
"""Coefficient of a gyroscope in deg/s."""

SMALLEST_RATE = 0.01
"""Least slow angular velocity about an axis, root mean square [rad/s]."""


LARGEST_TILT = 0.35
"""Largest angle between the mean specific force in the laboratory and its z axis [rad].

Over :data:`SHORTEST` the mean is gravity and the change of velocity: 2 m/s within 10 s move it by 0.02 rad.
"""


class AxisAgreement(NamedTuple):
    """Fit of the rate of the vertical's direction by the gyroscope, d f̂/dt = −c ω × f̂."""

    coefficient: float  # c; 1 if both sensors agree
    explained: float  # share of the power of d f̂/dt that it explains


def refuse_unfit_base(time: FloatArray, base: BaseMotion, torso: TorsoMotion | None, where: str) -> None:
    """Refuse a base motion that does not belong to a recording, or is wrong."""
    if not isinstance(base, BaseMotion):
        raise ExoidError(f"base is of type {type(base).__name__}", where=where, remedy="pass BaseMotion.from_imu(...)")
    if torso is not None:
        raise ExoidError(
            "the recording has a torso tilt and a base motion",
            where=where,
            remedy="leave out torso: the accelerometer measures the tilt",
        )
    checks.refuse_shape(base.columns, (len(time), len(BASE_COLUMNS)), "the base motion")
    refuse_wrong_base(time, base, where)
    if base.pose is not None:
        try:
            refuse_jumps(time, base.pose.position, base.pose.quaternion)
        except ExoidError as error:
            raise error.within(where) from None
        if time[-1] - time[0] >= SHORTEST:
            _refuse_other_vertical(base, base.pose, where)


def refuse_wrong_base(time: FloatArray, base: BaseMotion, where: str) -> None:
    """Refuse a base motion whose units or axes are wrong."""
    # The mean specific force of a base that neither falls nor flies is gravity. Averaged over seconds, its
    # direction f̂ is that of the vertical, which turns by d f̂/dt = −ω × f̂. A regression of both, filtered
    # alike, gives 1/57 for a gyroscope in deg/s, and −1 if the axes of one sensor have the opposite sign.
    size = float(np.median(np.linalg.norm(base.specific_force, axis=1)))
    low, high = (share * STANDARD_GRAVITY for share in LIKELY)
    if not low <= size <= high:
        raise ExoidError(_force_message(size), where=where, remedy=_force_remedy(size), command=_force_command(size))
    mean = base.specific_force.mean(axis=0)
    if mean[2] < UPSIDE_DOWN * np.linalg.norm(mean):
        raise ExoidError(
            f"the base is upside down: its accelerometer reads {mean[2]:.3g} m/s² along z on average",
            where=where,
            remedy="give the specific force in the axes of the root link, +9.81 m/s² along z at rest: turn its axes "
            "by rotation=, or change signs by a negative scale",
            command="change signs by a negative scale: --column base_acc_z=HEADER:-1",
        )
    speed = float(np.sqrt(np.mean(np.sum(base.angular_velocity**2, axis=1))))
    found = agreements(time, base)
    both = found[-1] if found else None
    in_degrees = both is not None and 0.5 < both.coefficient / DEGREES < 2.0 and both.explained > CONCLUSIVE
    if speed > FASTEST_MEAN or in_degrees:
        raise ExoidError(
            f"the gyroscope of the base reads {speed:.3g} rad/s (RMS)"
            + (f", and the vertical turns {1.0 / both.coefficient:.0f} times slower" if in_degrees and both else "")
            + ": it is in deg/s",
            where=where,
            remedy="give it in rad/s, or its unit: columns={'base_gyro_x': exoid.signals.Column(..., unit='deg/s')}",
            command="give its unit: --column base_gyro_x=HEADER:deg/s, and so for y and z",
        )
    for axis, one in zip("xy", found, strict=False):
        if one.explained > CONCLUSIVE and one.coefficient < -0.5:
            raise ExoidError(
                f"the gyroscope of the base turns about {axis} against the vertical of its accelerometer",
                where=where,
                remedy="give both sensors the axes of the root link: check the mounting (rotation=) and all signs",
                command=f"check the mounting; a negative scale changes a sign: --column base_gyro_{axis}=HEADER:-1",
            )


def _refuse_other_vertical(base: BaseMotion, pose: BasePose, where: str) -> None:
    """Refuse a pose by which gravity does not point down."""
    mean = np.einsum("nij,nj->i", pose.rotation, base.specific_force)
    angle = float(np.arctan2(np.linalg.norm(mean[:2]), mean[2]))
    if angle > LARGEST_TILT:
        raise ExoidError(
            f"by the pose of the base, gravity is {np.rad2deg(angle):.0f}° off the vertical of the laboratory",
            where=where,
            remedy="give the orientation of the root link as quaternions (x, y, z, w), laboratory from root link, in a "
            "laboratory whose z axis points up (exoid.signals.turn_upright)",
        )


def agreements(time: FloatArray, base: BaseMotion) -> tuple[AxisAgreement, ...]:
    """Compare gyroscope and accelerometer in slow motion."""
    interval = float(np.median(np.diff(time)))
    size = max(1, round(1.0 / (RATE * interval)))
    if len(base) * interval < SHORTEST:
        return ()
    few = base.averaged(size)
    force, omega = few.specific_force, few.angular_velocity
    direction = force / np.maximum(np.linalg.norm(force, axis=1, keepdims=True), SMALLEST_FORCE)
    width = max(1, round(WINDOW / (size * interval)))
    rate = _slow((direction[2:] - direction[:-2]) / (2.0 * size * interval), width)
    columns = [_slow(np.cross(direction, omega * axis)[1:-1], width) for axis in np.eye(3)]
    moving = [bool(np.sqrt(np.mean(np.sum(column**2, axis=1))) > SMALLEST_RATE) for column in columns[:2]]
    if not any(moving):
        return ()
    both = columns[0] + columns[1] + columns[2]
    each = [  # each axis has to explain what is left if the others are right
        _fit(columns[k], rate - (both - columns[k])) if moving[k] else AxisAgreement(1.0, 0.0) for k in range(2)
    ]
    return (*each, _fit(both, rate))


def _slow(signals: FloatArray, width: int) -> FloatArray:
    """Moving averages over ``width`` samples, one behind the other, less the mean, (N, 3)."""
    for _ in range(PASSES):
        signals = scipy.ndimage.uniform_filter1d(signals, width, axis=0)
    return np.asarray(signals - signals.mean(axis=0))


def _fit(x: FloatArray, y: FloatArray) -> AxisAgreement:
    """Least squares y = c x."""
    power, of_y = float(np.sum(x * x)), float(np.sum(y * y))
    if power == 0.0 or of_y == 0.0:
        return AxisAgreement(1.0, 0.0)
    product = float(np.sum(x * y))
    return AxisAgreement(product / power, product**2 / (power * of_y))


def _force_message(size: float) -> str:
    return f"the accelerometer of the base reads {size:.3g} m/s² (median), and gravity alone is 9.81"


def _force_remedy(size: float) -> str:
    share = size / STANDARD_GRAVITY
    if LIKELY[0] < size < LIKELY[1]:
        return "it is in g: multiply by 9.80665, or give its unit: exoid.signals.Column(..., unit='g')"
    if share < LIKELY[0]:
        return "give the specific force, which contains gravity: what the accelerometer reads, in m/s²"
    return "give it in m/s²"


def _force_command(size: float) -> str:
    if LIKELY[0] < size < LIKELY[1]:
        return "it is in g, give its unit: --column base_acc_x=HEADER:g, and so for y and z"
    return _force_remedy(size)
