"""Checks of a base motion: units of its sensors, and whether gyroscope and accelerometer have the same axes."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.leg.reduction.planar import GRAVITY
from exoid.leg.torso import TorsoMotion

from . import checks
from .base_motion import BASE_COLUMNS, BaseMotion
from .base_pose import refuse_jumps

CONCLUSIVE = 0.7
"""Least share of the power of the direction's rate that a coefficient explains, before it counts."""

SHORTEST = 10.0
"""Least length of a log that is compared [s]."""

_right: WeakKeyDictionary[BaseMotion, FloatArray] = WeakKeyDictionary()
"""Time stamps with which bases were found right: recordings that differ otherwise often have the same base."""


def refuse_unfit_base(time: FloatArray, base: BaseMotion, torso: TorsoMotion | None, *, touched: bool = True) -> None:
    """Refuse a base motion that does not belong to a recording, or is wrong."""
    if not isinstance(base, BaseMotion):
        raise UnreadableInputError(f"base is of type {type(base).__name__}", remedy="pass BaseMotion.from_imu(...)")
    if torso is not None:
        raise UnreadableInputError(
            "the recording has a torso tilt and a base motion",
            remedy="leave out torso: the accelerometer measures the tilt",
        )
    checks.refuse_shape(base.columns, (len(time), len(BASE_COLUMNS)), "the base motion")
    if not np.array_equal(time, _right.get(base, ())) and (touched or not flies(base.specific_force)):
        refuse_wrong_base(time, base)
        _right[base] = time
    if base.pose is not None:
        refuse_jumps(time, base.pose.position, base.pose.quaternion)
        # Over `SHORTEST` the mean is gravity and the change of velocity: 2 m/s within 10 s move it by 0.02 rad
        mean = np.einsum("nij,nj->i", base.pose.rotation, base.specific_force)
        angle = float(np.arctan2(np.linalg.norm(mean[:2]), mean[2]))
        if time[-1] - time[0] >= SHORTEST and angle > 0.35:
            raise UnreadableInputError(
                f"by the pose of the base, gravity is {np.rad2deg(angle):.0f}° off the vertical of the laboratory",
                remedy="give the orientation of the root link as quaternions (x, y, z, w), laboratory from root link, "
                "in a laboratory whose z axis points up (exoid.signals.turn_upright)",
            )


def flies(force: FloatArray) -> bool:
    """Tell whether an accelerometer reads no gravity, but only what limbs push and its own noise."""
    low, middle, high = np.quantile(np.linalg.norm(force, axis=1), [0.1, 0.5, 0.9])
    # one in g at rest reads little as well, but always the same: it is no flight
    return bool(middle < 0.6 * GRAVITY and low < 0.5 * high)


def refuse_wrong_base(time: FloatArray, base: BaseMotion) -> None:
    """Refuse a base motion whose units or axes are wrong."""
    # The mean specific force of a base that neither falls nor flies is gravity. Averaged over seconds, its
    # direction f̂ is that of the vertical, which turns by d f̂/dt = −ω × f̂. A regression of both, filtered
    # alike, gives 1/57 for a gyroscope in deg/s, and −1 if the axes of one sensor have the opposite sign.
    size = float(np.median(np.linalg.norm(base.specific_force, axis=1)))
    if not 0.6 <= size / GRAVITY <= 1.6:
        remedy = command = "give it in m/s²"
        if 0.6 < size < 1.6:
            remedy = "it is in g: multiply by 9.80665, or give its unit: exoid.signals.Column(..., unit='g')"
            command = "it is in g, give its unit: --column base_acc_x=HEADER:g, and so for y and z"
        elif size < 0.6 * GRAVITY:
            remedy = command = "give the specific force, which contains gravity: what the accelerometer reads, in m/s²"
        what = f"the accelerometer of the base reads {size:.3g} m/s² (median), and gravity alone is 9.81"
        raise UnreadableInputError(what, remedy=remedy, command=command)
    mean = base.specific_force.mean(axis=0)
    if mean[2] < -0.5 * np.linalg.norm(mean):  # cosine of the mean lean
        raise UnreadableInputError(
            f"the base is upside down: its accelerometer reads {mean[2]:.3g} m/s² along z on average",
            remedy="give the specific force in the axes of the root link, +9.81 m/s² along z at rest: turn its axes "
            "by rotation=, or change signs by a negative scale",
            command="change signs by a negative scale: --column base_acc_z=HEADER:-1",
        )
    speed = float(np.sqrt(np.mean(np.sum(base.angular_velocity**2, axis=1))))
    found = agreements(time, base)
    slope, explained = found[-1] if found else (1.0, 0.0)
    in_degrees = 0.5 < slope / np.deg2rad(1.0) < 2.0 and explained > CONCLUSIVE
    if speed > 15.0 or in_degrees:
        raise UnreadableInputError(
            f"the gyroscope of the base reads {speed:.3g} rad/s (RMS)"
            + (f", and the vertical turns {1.0 / slope:.0f} times slower" if in_degrees else "")
            + ": it is in deg/s",
            remedy="give it in rad/s, or its unit: columns={'base_gyro_x': exoid.signals.Column(..., unit='deg/s')}",
            command="give its unit: --column base_gyro_x=HEADER:deg/s, and so for y and z",
        )
    for axis, (slope, explained) in zip("xy", found, strict=False):
        if explained > CONCLUSIVE and slope < -0.5:
            raise UnreadableInputError(
                f"the gyroscope of the base turns about {axis} against the vertical of its accelerometer",
                remedy="give both sensors the axes of the root link: check the mounting (rotation=) and all signs",
                command=f"check the mounting; a negative scale changes a sign: --column base_gyro_{axis}=HEADER:-1",
            )


def agreements(time: FloatArray, base: BaseMotion) -> tuple[tuple[float, float], ...]:
    """Compare gyroscope and accelerometer in slow motion, about x, y and both: see :func:`_fit`."""
    interval = float(np.median(np.diff(time)))
    size = max(1, round(1.0 / (25.0 * interval)))  # the direction of gravity is followed at 25 Hz
    if len(base) * interval < SHORTEST:
        return ()
    few = base.averaged(size)
    force, omega = few.specific_force, few.angular_velocity
    direction = force / np.maximum(np.linalg.norm(force, axis=1, keepdims=True), 1e-6)
    # Three moving averages of 1 s keep what is slower than 0.3 Hz, where gravity outweighs motion: at 1 Hz, a base that
    # turns about a point 0.25 m above its sensor accelerates it against gravity's turn, and as much.
    width = max(1, round(1.0 / (size * interval)))
    rate = _slow((direction[2:] - direction[:-2]) / (2.0 * size * interval), width)
    columns = [_slow(np.cross(direction, omega * axis)[1:-1], width) for axis in np.eye(3)]
    moving = [bool(np.sqrt(np.mean(np.sum(column**2, axis=1))) > 0.01) for column in columns[:2]]
    if not any(moving):
        return ()
    both = columns[0] + columns[1] + columns[2]
    each = [  # each axis has to explain what is left if the others are right
        _fit(columns[k], rate - (both - columns[k])) if moving[k] else (1.0, 0.0) for k in range(2)
    ]
    return (*each, _fit(both, rate))


def _slow(signals: FloatArray, width: int) -> FloatArray:
    """Moving averages over ``width`` samples, one behind the other, less the mean, (N, 3)."""
    for _ in range(3):
        signals = scipy.ndimage.uniform_filter1d(signals, width, axis=0)
    return np.asarray(signals - signals.mean(axis=0))


def _fit(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Least squares y = c x, of d f̂/dt = −c ω × f̂: c, 1 if sensors agree, and the share of y² that it explains."""
    power, of_y = float(np.sum(x * x)), float(np.sum(y * y))
    if power == 0.0 or of_y == 0.0:
        return 1.0, 0.0
    product = float(np.sum(x * y))
    return product / power, product**2 / (power * of_y)
