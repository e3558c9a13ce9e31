"""Angular velocity and specific force of a body from its poses: a smoothing differentiator."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from . import checks, timebase
from .source_location import SourceLocation

STANDARD_GRAVITY = 9.81
"""Gravity, as in the models [m/s²]."""

STANDARD_CUTOFF = 10.0
"""Default cut-off frequency [Hz], above that of the filter that a recording passes later."""

DEGREE = 5
"""Degree of the polynomials."""

NORM_ERROR = 1e-2
"""Largest error of the norm of a quaternion that counts as rounding."""

FASTEST_TURN = 35.0
"""Largest plausible angular velocity of a base [rad/s], about 2000 deg/s."""

FASTEST = 20.0
"""Largest plausible velocity of a base [m/s]."""

STRONGEST = 100.0
"""Largest plausible acceleration of a base, root mean square [m/s²]."""

SMALLEST = 1e-9
"""Norm of a vertical below which it has no direction."""


def motion_of_pose(
    time: FloatArray, position: FloatArray, quaternion: FloatArray, cutoff: float, up: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Differentiate poses by polynomials of degree 5 over a window (Savitzky and Golay 1964).

    The window has 2 m + 1 samples with m = (6 · rate / (2 cutoff) + 4.6) / 3.2 (Schafer 2011).

    Args:
        time: Time stamps [s], (N,).
        position: Positions in the laboratory [m], (N, 3).
        quaternion: Orientations (x, y, z, w), laboratory from body, (N, 4).
        cutoff: −3 dB frequency [Hz].
        up: Direction against gravity in the laboratory, (3,).

    Returns:
        Angular velocity [rad/s] and specific force [m/s²] in the axes of the body, (N, 3) each.

    Raises:
        ExoidError: As for :meth:`exoid.BaseMotion.from_pose`.
    """
    where, samples = SourceLocation(), time.size
    checks.refuse_shape(time, (samples,), "time")
    checks.refuse_shape(position, (samples, 3), "position of the base")
    checks.refuse_shape(quaternion, (samples, 4), "quaternion")
    checks.refuse_shape(up, (3,), "up")
    checks.refuse_too_few(samples, where)
    columns = ("time", "base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw")
    checks.refuse_not_finite(np.column_stack([time, position, quaternion]), columns, where)
    checks.refuse_time_disorder(time, where)
    if not np.isfinite(up).all() or not np.linalg.norm(up) > SMALLEST:
        raise ExoidError("up has no direction", remedy="pass the direction against gravity, such as (0, 0, 1)")
    if not timebase.is_uniform(time):
        raise ExoidError("time stamps of the poses are uneven", remedy="resample the poses, as motion capture does")
    rate = timebase.sampling_rate(time)
    turns = _continuous(quaternion)
    _refuse_jumps(position, turns, rate)
    half = _half_window(rate, cutoff, samples)
    smooth, slope = (_savgol(turns, half, rate, deriv=order) for order in (0, 1))
    norm = np.linalg.norm(smooth, axis=1, keepdims=True)
    smooth, slope = smooth / norm, slope / norm
    body = scipy.spatial.transform.Rotation.from_quat(smooth)
    acceleration = _savgol(position, half, rate, deriv=2)
    if np.sqrt(np.mean(np.sum(acceleration**2, axis=1))) > STRONGEST:
        raise ExoidError(
            f"the poses accelerate by more than {STRONGEST:g} m/s²",
            remedy="give positions in m, or a lower cutoff",
        )
    gravity = -STANDARD_GRAVITY * up / np.linalg.norm(up)
    return _angular_velocity(smooth, slope), body.inv().apply(acceleration - gravity)


def _continuous(quaternion: FloatArray) -> FloatArray:
    """Normalise quaternions, and choose signs such that they do not jump: q and −q are one orientation."""
    norm = np.linalg.norm(quaternion, axis=1)
    worst = int(np.argmax(np.abs(norm - 1.0)))
    if abs(norm[worst] - 1.0) > NORM_ERROR:
        raise ExoidError(
            f"the quaternion of the base in row {worst} has norm {norm[worst]:.4g}",
            remedy="pass unit quaternions (x, y, z, w)",
        )
    unit = quaternion / norm[:, np.newaxis]
    flips = np.sum(unit[1:] * unit[:-1], axis=1) < 0.0
    signs = np.concatenate([[1.0], np.cumprod(np.where(flips, -1.0, 1.0))])
    return np.asarray(unit * signs[:, np.newaxis])


def _refuse_jumps(position: FloatArray, turns: FloatArray, rate: float) -> None:
    """Refuse poses that move faster than a base can."""
    overlap = np.clip(np.sum(turns[1:] * turns[:-1], axis=1), -1.0, 1.0)
    turning, moving = 2.0 * np.arccos(overlap) * rate, np.linalg.norm(np.diff(position, axis=0), axis=1) * rate
    for speeds, limit, unit, what in (
        (turning, FASTEST_TURN, "rad/s", "orientation"),
        (moving, FASTEST, "m/s", "position"),
    ):
        if speeds.max() > limit:
            raise ExoidError(
                f"the {what} of the base jumps before row {int(np.argmax(speeds)) + 1}: {speeds.max():.3g} {unit}",
                remedy="remove swapped or lost markers" + (", and give positions in m" if unit == "m/s" else ""),
            )


def _half_window(rate: float, cutoff: float, samples: int) -> int:
    """Samples on each side, for a −3 dB frequency."""
    if not 0.0 < cutoff < 0.5 * rate:
        raise ExoidError(f"a cutoff of {cutoff} Hz at {rate:.4g} Hz", remedy="pass one below half the rate")
    half = max(DEGREE // 2 + 1, round(((DEGREE + 1) * rate / (2.0 * cutoff) + 4.6) / 3.2))
    if 2 * half + 1 > samples:
        raise ExoidError(
            f"{samples} poses are too few for a cutoff of {cutoff:g} Hz", remedy="record longer, or raise the cutoff"
        )
    return half


def _savgol(x: FloatArray, half: int, rate: float, *, deriv: int) -> FloatArray:
    """Derivative of the polynomials that fit the neighbours of each sample best."""
    return np.asarray(
        scipy.signal.savgol_filter(x, 2 * half + 1, DEGREE, deriv=deriv, delta=1.0 / rate, axis=0, mode="interp")
    )


def _angular_velocity(turns: FloatArray, slope: FloatArray) -> FloatArray:
    """Vector part of 2 q̄ q̇, in the axes of the body, (N, 3)."""
    vector, scalar = turns[:, :3], turns[:, 3:]
    return np.asarray(2.0 * (scalar * slope[:, :3] - slope[:, 3:] * vector - np.cross(vector, slope[:, :3])))
