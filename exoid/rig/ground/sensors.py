"""Sensors of a machine on the ground: encoders, torque sensors, IMU, motion capture, force plates, foot switches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.signals import BaseMotion, BasePose, Wrench

from .motion import per_joint

Axes = Literal["link", "world"]
"""Axes of the logged wrenches: instrumented soles turn with the foot, force plates stand in the laboratory."""

MISLABELLED_TIME = 0.05
"""Length of a stretch of wrong labels [s]."""

NOT_NEGATIVE = (
    "angle_noise",
    "force_noise",
    "moment_noise",
    "gyro_noise",
    "acceleration_noise",
    "gyro_bias",
    "acceleration_bias",
    "imu_window",
    "position_noise",
    "turn_noise",
    "switch_force",
    "switch_delay",
)
"""Numbers of sensors that are zero or positive."""


@dataclass(frozen=True)
class GroundSensors:
    """Noise and faults of all sensors; noise is white, and its size a standard deviation.

    Attributes:
        angle_noise: Noise of the joint angles [rad].
        torque_noise: Noise of the torques [N·m]: a number, one a joint, or one for each joint of a leg.
        force_noise: Noise of each component of a measured force [N].
        moment_noise: Noise of each component of a measured moment [N·m].
        gyro_noise: Noise of the gyroscope [rad/s].
        acceleration_noise: Noise of the accelerometer [m/s²].
        gyro_bias: Standard deviation of the constant bias of each axis of the gyroscope [rad/s], drawn for each log.
        acceleration_bias: The same of the accelerometer [m/s²].
        imu_window: Time over which the IMU takes means [s], as its low-pass does; 2 ms is a bandwidth of 220 Hz. Zero
            reads velocity and acceleration of one step of the simulation.
        imu_position: Place of the IMU in the axes of the root link [m], (3,), which the log states.
        imu_misalignment: Rotation vector of a mounting of the IMU that the log does not state [rad], (3,).
        position_noise: Noise of each coordinate of motion capture [m].
        turn_noise: Noise of the orientation of motion capture about each axis [rad].
        wrench_axes: "link" for instrumented soles, "world" for force plates, whose log has the pose of the torso.
        switch_force: Vertical force from which a foot switch is closed [N].
        switch_delay: Delay of foot switches [s].
        mislabelled: Share of the samples of stance, in stretches of 50 ms, in which a foot switch is open.

    Raises:
        ExoidError: A number has the wrong sign or is not finite, or the axes are unknown.
    """

    angle_noise: float = 1e-4
    torque_noise: tuple[float, ...] | float = (0.5, 0.4, 0.2)
    force_noise: float = 3.0
    moment_noise: float = 0.3
    gyro_noise: float = 0.005
    acceleration_noise: float = 0.05
    gyro_bias: float = 0.0
    acceleration_bias: float = 0.0
    imu_window: float = 2e-3
    imu_position: tuple[float, float, float] = (0.05, 0.0, 0.25)
    imu_misalignment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    position_noise: float = 2e-4
    turn_noise: float = 1e-3
    wrench_axes: Axes = "link"
    switch_force: float = 20.0
    switch_delay: float = 0.0
    mislabelled: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in NOT_NEGATIVE:
            if not 0.0 <= getattr(self, name) < np.inf:
                raise ExoidError(f"{name} of the sensors is {getattr(self, name)}", remedy="give a finite number ≥ 0")
        for name in ("imu_position", "imu_misalignment"):
            if np.shape(getattr(self, name)) != (3,) or not np.isfinite(getattr(self, name)).all():
                raise ExoidError(f"{name} of the sensors is {getattr(self, name)}", remedy="give three finite numbers")
        if not 0.0 <= self.mislabelled < 1.0:
            raise ExoidError(f"a share of {self.mislabelled} mislabelled samples", remedy="give one from 0 to below 1")
        if self.wrench_axes not in get_args(Axes):
            raise ExoidError(f"wrenches in axes {self.wrench_axes!r}", remedy=f"use one of {', '.join(get_args(Axes))}")

    @classmethod
    def exact(cls, *, wrench_axes: Axes = "link") -> GroundSensors:
        """Make sensors without noise, whose IMU reads single steps.

        Args:
            wrench_axes: Axes of the wrenches.

        Returns:
            Sensors that read the truth.
        """
        return cls(
            angle_noise=0.0,
            torque_noise=0.0,
            force_noise=0.0,
            moment_noise=0.0,
            gyro_noise=0.0,
            acceleration_noise=0.0,
            imu_window=0.0,
            position_noise=0.0,
            turn_noise=0.0,
            wrench_axes=wrench_axes,
        )

    def angles(self, q: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Read joint angles.

        Args:
            q: True angles [rad], (N, n).
            rng: Generator of the noise.

        Returns:
            Readings [rad], (N, n).
        """
        return _noisy(q, self.angle_noise, rng)

    def torques(self, tau: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Read joint torques.

        Args:
            tau: True torques [N·m], (N, n).
            rng: Generator of the noise.

        Returns:
            Readings [N·m], (N, n).

        Raises:
            ExoidError: The noise does not fit the number of joints.
        """
        return _noisy(tau, per_joint(self.torque_noise, tau.shape[1], "torque_noise"), rng)

    def imu(self, base: BaseKinematics, rng: np.random.Generator, pose: BasePose | None = None) -> BaseMotion:
        """Read the IMU.

        Args:
            base: True motion of the root link.
            rng: Generator of noise and bias.
            pose: Measured pose of the torso; None without motion capture.

        Returns:
            Readings.
        """
        place = np.array(self.imu_position)
        turn = scipy.spatial.transform.Rotation.from_rotvec(self.imu_misalignment).as_matrix()
        gyro, force = base.angular_velocity @ turn, base.specific_force_at(place) @ turn
        biases = (size * rng.standard_normal(3) for size in (self.gyro_bias, self.acceleration_bias))
        gyro_bias, force_bias = biases
        return BaseMotion.from_imu(
            _noisy(gyro + gyro_bias, self.gyro_noise, rng),
            _noisy(force + force_bias, self.acceleration_noise, rng),
            position=place,
            pose=pose,
        )

    def pose(self, position: FloatArray, rotation: FloatArray, rng: np.random.Generator) -> BasePose:
        """Read motion capture.

        Args:
            position: True position of the root link's origin [m], (N, 3).
            rotation: True axes of the root link as columns, (N, 3, 3).
            rng: Generator of the noise.

        Returns:
            Readings.
        """
        orientation = scipy.spatial.transform.Rotation
        turn = orientation.from_rotvec(self.turn_noise * rng.standard_normal((len(position), 3)))
        place = _noisy(position, self.position_noise, rng)
        return BasePose(place, (orientation.from_matrix(rotation) * turn).as_quat())

    def wrench(self, wrench: Wrench, rng: np.random.Generator) -> Wrench:
        """Read a force plate, an instrumented sole or the sensor of a hand rail.

        Args:
            wrench: True wrench.
            rng: Generator of the noise.

        Returns:
            Readings in the same axes and about the same point.
        """
        return Wrench(
            _noisy(wrench.force, self.force_noise, rng),
            _noisy(wrench.moment, self.moment_noise, rng),
            wrench.point,
            wrench.axes,
        )

    def switch(self, force: FloatArray, rate: float, rng: np.random.Generator) -> BoolArray:
        """Read a foot switch.

        Args:
            force: True vertical force on the foot [N], (N,).
            rate: Rate of the log [Hz].
            rng: Generator of the mistakes.

        Returns:
            Whether the switch is closed, (N,).
        """
        delay = round(self.switch_delay * rate)
        closed = force > self.switch_force
        if delay:
            closed = np.concatenate([np.full(min(delay, len(closed)), closed[0]), closed[:-delay]])
        return _mislabel(closed, self.mislabelled, max(1, round(MISLABELLED_TIME * rate)), rng)


def _noisy(x: FloatArray, std: float | FloatArray, rng: np.random.Generator) -> FloatArray:
    return np.asarray(x + std * rng.standard_normal(x.shape))


def _mislabel(closed: BoolArray, share: float, stretch: int, rng: np.random.Generator) -> BoolArray:
    """Open a switch in random stretches, until a share of its closed samples is wrong."""
    out, wrong = closed.copy(), round(share * int(closed.sum()))
    while wrong > 0:
        start = int(rng.choice(np.flatnonzero(out)))
        part = np.flatnonzero(out[start : start + min(stretch, wrong)]) + start
        out[part] = False
        wrong -= len(part)
    return out
