"""Angular velocity and specific force of a body from its poses: a smoothing differentiator."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from . import checks, timebase
from .base_pose import POSE_COLUMNS, continuous, refuse_jumps
from .source_location import SourceLocation

STANDARD_GRAVITY = 9.81
"""Gravity, as in the models [m/s²]."""

STANDARD_CUTOFF = 10.0
"""Default cut-off frequency [Hz], above that of the filter that a recording passes later."""

DEGREE = 5
"""Degree of the polynomials."""


class PoseMotion(NamedTuple):
    """Motion of a body that follows from its poses."""

    angular_velocity: FloatArray  # angular velocity in the axes of the body [rad/s], (N, 3)
    specific_force: FloatArray  # specific force in the axes of the body [m/s²], (N, 3)
    position: FloatArray  # smoothed positions in the laboratory [m], (N, 3)
    quaternion: FloatArray  # smoothed orientations (x, y, z, w), laboratory from body, (N, 4)


def motion_of_pose(
    time: FloatArray, position: FloatArray, quaternion: FloatArray, cutoff: float, up: FloatArray
) -> PoseMotion:
    """Differentiate poses by polynomials of degree 5 over a window (Savitzky and Golay 1964)."""
    # The window has 2 m + 1 samples with m = (6 · rate / (2 cutoff) + 4.6) / 3.2 (Schafer 2011).
    where, samples = SourceLocation(), time.size
    checks.refuse_shape(time, (samples,), "time")
    checks.refuse_shape(position, (samples, 3), "position of the base")
    checks.refuse_shape(quaternion, (samples, 4), "quaternion")
    checks.refuse_too_few(samples, where)
    checks.refuse_not_finite(np.column_stack([time, position, quaternion]), ("time", *POSE_COLUMNS), where)
    checks.refuse_time_disorder(time, where)
    if not timebase.is_uniform(time):
        raise BadArgumentError(
            "time stamps of the poses are uneven", remedy="resample the poses, as motion capture does"
        )
    rate = timebase.sampling_rate(time)
    turns = continuous(quaternion)
    refuse_jumps(time, position, turns)
    half = _half_window(rate, cutoff, samples)
    smooth, slope = (_savgol(turns, half, rate, deriv=order) for order in (0, 1))
    norm = np.linalg.norm(smooth, axis=1, keepdims=True)
    smooth, slope = smooth / norm, slope / norm
    body = scipy.spatial.transform.Rotation.from_quat(smooth)
    place, acceleration = (_savgol(position, half, rate, deriv=order) for order in (0, 2))
    if np.sqrt(np.mean(np.sum(acceleration**2, axis=1))) > 100.0:  # root mean square [m/s²]
        raise BadArgumentError(
            "the poses accelerate by more than 100 m/s²",
            remedy="give positions in m, or a lower cutoff",
        )
    gravity = -STANDARD_GRAVITY * up / np.linalg.norm(up)
    force = np.asarray(body.inv().apply(acceleration - gravity))
    return PoseMotion(twice_imaginary(smooth, slope), force, place, smooth)


def _half_window(rate: float, cutoff: float, samples: int) -> int:
    """Samples on each side, for a −3 dB frequency."""
    if not 0.0 < cutoff < 0.5 * rate:
        raise BadArgumentError(f"a cutoff of {cutoff} Hz at {rate:.4g} Hz", remedy="pass one below half the rate")
    half = max(DEGREE // 2 + 1, round(((DEGREE + 1) * rate / (2.0 * cutoff) + 4.6) / 3.2))
    if 2 * half + 1 > samples:
        raise BadArgumentError(
            f"{samples} poses are too few for a cutoff of {cutoff:g} Hz", remedy="record longer, or raise the cutoff"
        )
    return half


def _savgol(x: FloatArray, half: int, rate: float, *, deriv: int) -> FloatArray:
    """Derivative of the polynomials that fit the neighbours of each sample best."""
    return np.asarray(
        scipy.signal.savgol_filter(x, 2 * half + 1, DEGREE, deriv=deriv, delta=1.0 / rate, axis=0, mode="interp")
    )


def twice_imaginary(h: FloatArray, other: FloatArray) -> FloatArray:
    """2 Im(h* g) of quaternions (x, y, z, w), (N, 3): with g = ḣ the angular velocity in the axes of the body."""
    vector, scalar = h[:, :3], h[:, 3:]
    return np.asarray(2.0 * (scalar * other[:, :3] - other[:, 3:] * vector - np.cross(vector, other[:, :3])))
