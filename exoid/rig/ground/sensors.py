"""Sensors of a machine on the ground: encoders, torque sensors, IMU, motion capture, force plates, foot switches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Literal, get_args

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.rig.sensors import noisy
from exoid.signals import BaseMotion, BasePose
from exoid.tools.numbers import checked

Axes = Literal["link", "world"]
"""Axes of the logged wrenches: instrumented soles turn with the foot, force plates stand in the laboratory."""


@dataclass(frozen=True, eq=False, repr=False)
class Steps:
    """What sensors of limited bandwidth read at every step, and which steps are samples of the log."""

    base: BaseKinematics  # motion of the root link at M steps; its velocity is that of half a step before
    torque: FloatArray  # torques of the actuators [N·m], (M, n)
    hold: FloatArray  # force and moment of what holds the torso, in its axes [N, N·m], (M, 6)
    ground: Mapping[str, FloatArray]  # force and moment on each foot about the laboratory's origin [N, N·m], (M, 6)
    samples: NDArray[np.intp]  # step of each sample of the log, (N,)
    dt: float  # step [s]

    def base_motion(self, window: float) -> BaseKinematics:
        """Means of the motion of the root link over a window."""
        base, between = self.base, np.append(0.0, np.ones(2 * self._half(window)))
        turning, force = (self.read(x, window) for x in (base.angular_acceleration, base.specific_force))
        return BaseKinematics(self._mean(base.angular_velocity, between), turning, force)

    def read(self, values: FloatArray, window: float) -> FloatArray:
        """Means (N, k) over a window about each sample; values of single steps for a window of zero."""
        if not window:
            return values[self.samples]
        # the first and the last step of the window count half
        return self._mean(values, np.convolve(np.ones(2 * self._half(window)), (0.5, 0.5)))

    def _half(self, window: float) -> int:
        """Number of steps in half a window."""
        return max(1, round(0.5 * window / self.dt))

    def _mean(self, x: FloatArray, weights: FloatArray) -> FloatArray:
        """Weighted mean about each sample, (N, k); the ends of the run are continued by their values."""
        means = scipy.ndimage.correlate1d(x, weights / weights.sum(), axis=0, mode="nearest")
        return np.asarray(means[self.samples])


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
        window: Time over which IMU, torque sensors, force plates, soles and the load cell of what holds the torso take
            means [s], as their low-pass does; 2 ms is a bandwidth of 220 Hz. Zero reads one step of the simulation.
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
    window: float = 2e-3
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
        others = ("imu_position", "imu_misalignment", "torque_noise", "wrench_axes")
        for field in fields(self):
            if field.name not in others:
                checked(getattr(self, field.name), field.name, least=0.0)
        for name in ("imu_position", "imu_misalignment"):
            if checked(getattr(self, name), name).shape != (3,):
                what = f"{name} of the sensors is {getattr(self, name)}"
                raise BadArgumentError(what, remedy="give three finite numbers")
        checked(self.mislabelled, "mislabelled", most=0.99)  # a switch that is never closed has no stance
        if self.wrench_axes not in get_args(Axes):
            what, remedy = f"wrenches in axes {self.wrench_axes!r}", f"use one of {', '.join(get_args(Axes))}"
            raise BadArgumentError(what, remedy=remedy)

    @classmethod
    def exact(cls, *, wrench_axes: Axes = "link") -> GroundSensors:
        """Make sensors without noise that read single steps.

        Args:
            wrench_axes: Axes of the wrenches.

        Returns:
            Sensors that read the truth.
        """
        noises = ("angle", "torque", "force", "moment", "gyro", "acceleration", "position", "turn")
        zeros: dict[str, Any] = {f"{name}_noise": 0.0 for name in noises}
        return cls(window=0.0, wrench_axes=wrench_axes, **zeros)


def read_imu(
    sensors: GroundSensors, base: BaseKinematics, rng: np.random.Generator, pose: BasePose | None
) -> BaseMotion:
    """Read an IMU; a pose comes from motion capture."""
    place = np.array(sensors.imu_position)
    turn = scipy.spatial.transform.Rotation.from_rotvec(sensors.imu_misalignment).as_matrix()
    gyro, force = base.angular_velocity @ turn, base.specific_force_at(place) @ turn
    gyro_bias, force_bias = (size * rng.standard_normal(3) for size in (sensors.gyro_bias, sensors.acceleration_bias))
    return BaseMotion.from_imu(
        noisy(gyro + gyro_bias, sensors.gyro_noise, rng),
        noisy(force + force_bias, sensors.acceleration_noise, rng),
        position=place,
        pose=pose,
    )


def read_pose(sensors: GroundSensors, position: FloatArray, rotation: FloatArray, rng: np.random.Generator) -> BasePose:
    """Read motion capture of the root link's origin, (N, 3), and axes, (N, 3, 3)."""
    orientation = scipy.spatial.transform.Rotation
    turn = orientation.from_rotvec(sensors.turn_noise * rng.standard_normal((len(position), 3)))
    place = noisy(position, sensors.position_noise, rng)
    return BasePose(place, (orientation.from_matrix(rotation) * turn).as_quat())


def read_switch(sensors: GroundSensors, force: FloatArray, rate: float, rng: np.random.Generator) -> BoolArray:
    """Read a foot switch under a vertical force, (N,)."""
    delay = round(sensors.switch_delay * rate)
    closed = force > sensors.switch_force
    if delay:
        closed = np.concatenate([np.full(min(delay, len(closed)), closed[0]), closed[:-delay]])
    out, wrong = closed.copy(), round(sensors.mislabelled * int(closed.sum()))
    stretch = max(1, round(0.05 * rate))  # mistakes come in stretches of 50 ms
    while wrong > 0:
        start = int(rng.choice(np.flatnonzero(out)))
        part = np.flatnonzero(out[start : start + min(stretch, wrong)]) + start
        out[part] = False
        wrong -= len(part)
    return out
