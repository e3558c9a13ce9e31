"""Base motion: what an inertial measurement unit on the root link measures during a recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.reduction.planar import GRAVITY

from . import checks, timebase
from .base_pose import POSE_COLUMNS, BasePose, continuous, refuse_jumps, twice_imaginary
from .differentiation import difference, smooth_motion
from .timebase import Sampled

BASE_COLUMNS = ("base_gyro_x", "base_gyro_y", "base_gyro_z", "base_acc_x", "base_acc_y", "base_acc_z")
"""Columns of a log: angular velocity [rad/s] and specific force [m/s²] in the axes of the base."""


@dataclass(frozen=True, eq=False, repr=False)
class BaseMotion(Sampled):
    """Angular velocity and specific force of the base at the samples of a recording.

    The base is the root link of the URDF, and all vectors are in its axes, whose z axis points up when it stands
    upright. Torques of the joints depend on the base only through ω, ω̇ and f = Rᵀ(p̈ − g): its orientation, position
    and heading need not be known. An inertial measurement unit (IMU) at r measures ω and f(r); elsewhere

        f(h) = f(r) + ω̇ × (h − r) + ω × (ω × (h − r)).

    Angles and torques of the recording pass filters, and so does this motion: ω̇ is derived from the smoothed ω.

    Attributes:
        angular_velocity: ω [rad/s], (N, 3).
        specific_force: f, what an accelerometer reads [m/s²], (N, 3): (0, 0, 9.81) at rest.
        position: Position r of the sensor in the axes of the root link [m], (3,).
        pose: Pose of the root link in the laboratory, which only wrenches in axes of the laboratory need; None where it
            was not recorded, as by an IMU.
        calibrated: Whether there is no bias to look for.

    Raises:
        ExoidError: Shapes do not fit, a number is missing, or the position is not in m.

    Example:
        >>> BaseMotion(np.zeros((100, 3)), np.tile([0.0, 0.0, 9.81], (100, 1)))
        BaseMotion(100 samples, sensor at (0, 0, 0) m)
    """

    angular_velocity: FloatArray
    specific_force: FloatArray
    position: FloatArray = (0.0, 0.0, 0.0)  # type: ignore[assignment]  # an array once it is made
    pose: BasePose | None = None
    calibrated: bool = False

    def __post_init__(self) -> None:
        for name in ("angular_velocity", "specific_force", "position"):
            object.__setattr__(self, name, checks.as_numbers(getattr(self, name), f"{name} of the base"))
        samples = len(np.atleast_1d(self.angular_velocity))
        checks.refuse_shape(self.angular_velocity, (samples, 3), "angular_velocity of the base")
        checks.refuse_shape(self.specific_force, (samples, 3), "specific_force of the base")
        checks.refuse_shape(self.position, (3,), "position of the sensor on the base")
        checks.refuse_not_finite(self.columns, BASE_COLUMNS)
        checks.refuse_implausible("", self.columns, BASE_COLUMNS)
        if not (np.abs(self.position) <= 5.0).all():  # larger ones are in another unit
            raise BadArgumentError(
                f"the sensor of the base is at {_point(self.position)} m of the root link",
                remedy="give its position in m, at most 5 m from the origin of the root link",
            )
        if self.pose is not None and len(self.pose) != samples:
            raise BadArgumentError(
                f"the pose of the base has {len(self.pose)} samples, and its motion {samples}",
                remedy="give both at the same time stamps",
            )

    @classmethod
    def from_imu(
        cls,
        gyro: ArrayLike,
        specific_force: ArrayLike,
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        rotation: ArrayLike | None = None,
        pose: BasePose | None = None,
    ) -> BaseMotion:
        """Turn the readings of an IMU into the axes of the base.

        Args:
            gyro: Angular velocity in the axes of the sensor [rad/s], (N, 3).
            specific_force: Reading of the accelerometer in the axes of the sensor [m/s²], (N, 3).
            position: Position of the sensor in the axes of the root link [m], (3,).
            rotation: Mounting: axes of the sensor as columns, in the axes of the root link, (3, 3); None if they are
                parallel.
            pose: Pose of the root link where something else measured it; None otherwise.

        Returns:
            The motion of the base.

        Raises:
            ExoidError: Shapes do not fit, a number is missing, or the mounting is no rotation.
        """
        readings = [checks.as_numbers(gyro, "gyro"), checks.as_numbers(specific_force, "specific_force")]
        for name, reading in zip(("gyro", "specific_force"), readings, strict=True):
            checks.refuse_shape(reading, (len(np.atleast_1d(readings[0])), 3), name)
        if rotation is not None:
            mounting = checks.as_numbers(rotation, "rotation")
            checks.refuse_shape(mounting, (3, 3), "rotation")
            error = np.abs(mounting @ mounting.T - np.eye(3)).max()
            if not error <= 1e-3 or np.linalg.det(mounting) < 0.0:
                raise BadArgumentError(
                    "the mounting of the sensor is not a rotation"
                    + ("; its axes are left-handed" if error <= 1e-3 else ""),
                    remedy="pass a (3, 3) matrix whose columns are the sensor's x, y, z in the axes of the root link",
                )
            readings = [reading @ mounting.T for reading in readings]
        return cls(readings[0], readings[1], checks.as_numbers(position, "position"), pose)

    @classmethod
    def from_pose(
        cls,
        position: ArrayLike,
        quaternion: ArrayLike,
        time: ArrayLike,
        *,
        cutoff: float = 10.0,
        at: ArrayLike = (0.0, 0.0, 0.0),
    ) -> BaseMotion:
        """Derive the motion of the base from poses, such as those of motion capture.

        Orientation R and position p pass the low-pass of joint angles, central differences follow, and f = Rᵀ(p̈ − g).
        Rows are formed of the pose itself, behind the filter of the angles. An error of the vertical is an error of
        gravity: 10 mrad are 0.1 m/s².

        Args:
            position: Position of a tracked point of the root link in a laboratory whose z axis points up [m], (N, 3).
                See :func:`exoid.signals.turn_upright` for other laboratories.
            quaternion: Orientation (x, y, z, w): laboratory from root link, (N, 4), of norm 1.
            time: Time stamps [s], (N,), evenly spaced.
            cutoff: −3 dB frequency of the low-pass [Hz], above that of the filter that a recording passes later.
            at: Position of the tracked point in the axes of the root link [m], (3,).

        Returns:
            The motion of the base, with its pose as measured.

        Raises:
            ExoidError: Shapes do not fit, a number is missing, a quaternion is not of norm 1, the pose jumps, time is
                not even, or the cut-off does not fit the rate.
        """
        stamps, points = checks.as_numbers(time, "time"), checks.as_numbers(position, "position of the base")
        turns = checks.as_numbers(quaternion, "quaternion")
        checks.refuse_shape(stamps, (stamps.size,), "time")
        checks.refuse_shape(points, (stamps.size, 3), "position of the base")
        checks.refuse_shape(turns, (stamps.size, 4), "quaternion")
        checks.refuse_too_few(stamps.size)
        checks.refuse_not_finite(np.column_stack([stamps, points, turns]), ("time", *POSE_COLUMNS))
        checks.refuse_time_disorder(stamps)
        if not timebase.is_uniform(stamps):
            raise BadArgumentError(
                "time stamps of the poses are uneven", remedy="resample the poses, as motion capture does"
            )
        unit, rate = continuous(turns), timebase.sampling_rate(stamps)
        refuse_jumps(stamps, points, unit)
        place, h = np.hsplit(smooth_motion(np.hstack([points, unit]), rate, cutoff), [3])
        h = h / np.linalg.norm(h, axis=1, keepdims=True)
        acceleration = difference(place, rate, 2, 4)
        if np.sqrt(np.mean(np.sum(acceleration**2, axis=1))) > 100.0:  # root mean square [m/s²]
            raise BadArgumentError(
                "the poses accelerate by more than 100 m/s²", remedy="give positions in m, or a lower cutoff"
            )
        root = scipy.spatial.transform.Rotation.from_quat(h)
        force = root.apply(acceleration - np.array([0.0, 0.0, -GRAVITY]), inverse=True)
        motion = cls.from_imu(twice_imaginary(h, difference(h, rate, 1, 4)), force, position=at)
        # The pose stays as it is: smoothed here, it would hide its noise from the choice of the cut-off
        measured = scipy.spatial.transform.Rotation.from_quat(turns.copy())
        origin = points - measured.apply(motion.position.copy())
        return replace(motion, pose=BasePose(origin, turns), calibrated=True)

    @property
    def columns(self) -> FloatArray:
        """Columns in the order of :data:`BASE_COLUMNS`, (N, 6)."""
        return np.hstack([self.angular_velocity, self.specific_force])

    def rows(self, rows: slice | BoolArray) -> BaseMotion:
        """Select samples."""
        pose = None if self.pose is None else self.pose.rows(rows)
        return BaseMotion(self.angular_velocity[rows], self.specific_force[rows], self.position, pose, self.calibrated)

    def _changed(self, change: Callable[[FloatArray, bool], FloatArray]) -> BaseMotion:
        turning, force = change(self.angular_velocity, True), change(self.specific_force, False)  # impacts make it jump
        pose = None if self.pose is None else self.pose._changed(change)
        return replace(self, angular_velocity=turning, specific_force=force, pose=pose)

    def __len__(self) -> int:
        return len(self.angular_velocity)

    def __repr__(self) -> str:
        return f"BaseMotion({len(self)} samples, sensor at {_point(self.position)} m)"


def _point(position: FloatArray) -> str:
    return f"({', '.join(f'{x:.4g}' for x in position.tolist())})"
