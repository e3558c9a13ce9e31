"""Pose of the base in the laboratory during a recording, and the motion that follows from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.reduction.planar import GRAVITY

from . import checks, timebase
from .timebase import Sampled

POSE_COLUMNS = ("base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw")
"""Columns of a pose: position [m] and quaternion of the root link in the laboratory, whose z axis points up."""


@dataclass(frozen=True, eq=False, repr=False)
class BasePose(Sampled):
    """Position and orientation of the root link in the laboratory, at the samples of a recording.

    The z axis of the laboratory points up. Quaternions are normalised when the pose is made, and their signs are
    chosen such that they do not jump: q and −q are one orientation.

    Attributes:
        position: Position of the root link's origin [m], (N, 3).
        quaternion: Orientation (x, y, z, w), laboratory from root link, (N, 4).

    Raises:
        ExoidError: Shapes do not fit, a number is missing, or a quaternion is not of norm 1.

    Example:
        >>> BasePose(np.zeros((10, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (10, 1))).rotation[0]
        array([[1., 0., 0.],
               [0., 1., 0.],
               [0., 0., 1.]])
    """

    position: FloatArray
    quaternion: FloatArray

    def __post_init__(self) -> None:
        for name in ("position", "quaternion"):
            object.__setattr__(self, name, checks.as_numbers(getattr(self, name), f"{name} of the base"))
        samples = len(np.atleast_1d(self.position))
        checks.refuse_shape(self.position, (samples, 3), "position of the base")
        checks.refuse_shape(self.quaternion, (samples, 4), "quaternion")
        checks.refuse_not_finite(self.columns, POSE_COLUMNS)
        checks.refuse_implausible("", self.columns, POSE_COLUMNS)
        object.__setattr__(self, "quaternion", checks.as_numbers(continuous(self.quaternion), "quaternion"))

    @cached_property
    def rotation(self) -> FloatArray:
        """Rotation matrices, laboratory from root link, (N, 3, 3)."""
        return np.asarray(scipy.spatial.transform.Rotation.from_quat(self.quaternion.copy()).as_matrix())

    @property
    def columns(self) -> FloatArray:
        """Columns in the order of :data:`POSE_COLUMNS`, (N, 7)."""
        return np.hstack([self.position, self.quaternion])

    def rows(self, rows: slice | BoolArray) -> BasePose:
        """Select samples."""
        return BasePose(self.position[rows], self.quaternion[rows])

    def _changed(self, change: Callable[[FloatArray, bool], FloatArray]) -> BasePose:
        columns = change(self.columns, True)
        return BasePose(columns[:, :3], _unit(columns[:, 3:]))

    def __len__(self) -> int:
        return len(self.position)

    def __repr__(self) -> str:
        return f"BasePose({len(self)} samples)"


def continuous(quaternion: FloatArray) -> FloatArray:
    """Normalise quaternions, and choose signs such that they do not jump."""
    if not len(quaternion):
        return quaternion
    norm = np.linalg.norm(quaternion, axis=1)
    worst = int(np.argmax(np.abs(norm - 1.0)))
    if abs(norm[worst] - 1.0) > 1e-2:  # less is rounding
        raise BadArgumentError(
            f"the quaternion of the base in row {worst} has norm {norm[worst]:.4g}",
            remedy="pass unit quaternions (x, y, z, w)",
        )
    # Exact ones stay as they are, so that files read back exactly
    unit = np.where(np.abs(norm - 1.0)[:, np.newaxis] < 1e-14, quaternion, quaternion / norm[:, np.newaxis])
    flips = np.sum(unit[1:] * unit[:-1], axis=1) < 0.0
    signs = np.concatenate([[1.0], np.cumprod(np.where(flips, -1.0, 1.0))])
    return np.asarray(unit * signs[:, np.newaxis])


def refuse_jumps(time: FloatArray, position: FloatArray, quaternion: FloatArray) -> None:
    """Refuse poses that move faster than a base can."""
    interval = np.diff(time)
    overlap = np.clip(np.sum(quaternion[1:] * quaternion[:-1], axis=1), -1.0, 1.0)
    turning = 2.0 * np.arccos(overlap) / interval
    moving = np.linalg.norm(np.diff(position, axis=0), axis=1) / interval
    for speeds, limit, unit, what in ((turning, 35.0, "rad/s", "orientation"), (moving, 20.0, "m/s", "position")):
        if speeds.max() > limit:
            raise BadArgumentError(
                f"the {what} of the base jumps before row {int(np.argmax(speeds)) + 1}: {speeds.max():.3g} {unit}",
                remedy="remove swapped or lost markers" + (", and give positions in m" if unit == "m/s" else ""),
            )


def turn_upright(up: ArrayLike) -> FloatArray:
    """Compute the shortest rotation that turns the vertical of a laboratory to z.

    Args:
        up: Direction against gravity in the laboratory, (3,): (0, 1, 0) where y points up.

    Returns:
        Rotation matrix, (3, 3): ``vectors @ matrix.T`` are vectors in axes whose z points up.

    Raises:
        ExoidError: It has no direction.

    Example:
        >>> turn_upright((0.0, 1.0, 0.0)) @ (0.1, 1.0, 0.2)
        array([ 0.1, -0.2,  1. ])
    """
    x, y, z = checks.as_direction(up)
    if z < -1.0 + 1e-9:
        return np.diag([1.0, -1.0, -1.0])
    # Rodrigues' formula about up × z = (y, −x, 0)
    return np.array(
        [
            [1.0 - x * x / (1.0 + z), -x * y / (1.0 + z), -x],
            [-x * y / (1.0 + z), 1.0 - y * y / (1.0 + z), -y],
            [x, y, z],
        ]
    )


def _unit(quaternion: FloatArray) -> FloatArray:
    return np.asarray(quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True))


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
    samples = time.size
    checks.refuse_shape(time, (samples,), "time")
    checks.refuse_shape(position, (samples, 3), "position of the base")
    checks.refuse_shape(quaternion, (samples, 4), "quaternion")
    checks.refuse_too_few(samples)
    checks.refuse_not_finite(np.column_stack([time, position, quaternion]), ("time", *POSE_COLUMNS))
    checks.refuse_time_disorder(time)
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
            "the poses accelerate by more than 100 m/s²", remedy="give positions in m, or a lower cutoff"
        )
    gravity = -GRAVITY * up / np.linalg.norm(up)
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
