"""Virtual logs of a leg on a base that moves as a walking wearer's torso does, with an IMU on it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from exoid import BaseMotion, Leg, Recording
from exoid.leg.base_kinematics import BaseKinematics

Array = NDArray[np.float64]

IMU = np.array([0.05, 0.02, 0.25])
"""Position of the sensor in the axes of the root link [m]."""

GYRO_NOISE, FORCE_NOISE, ANGLE_NOISE = 0.005, 0.05, 1e-4
TORQUE_NOISE = np.array([0.5, 0.4, 0.2])

SHARES = np.array([0.31, 1.0, 1.53, 2.1])
"""Frequencies of the parts of a motion, over the main one."""

SIZES = np.array([0.5, 1.0, 0.5, 0.25])


@dataclass(frozen=True, eq=False)
class Walk:
    """Motion of joints and base, smooth and known exactly.

    Attributes:
        leg: The leg.
        seconds: Duration [s].
        rate: [Hz].
        seed: Seed of phases.
        sideways: Amplitude of roll and yaw [rad]; 0 stays in the plane of the leg.
        pitch: Amplitude of the pitch [rad].
        frequency: Main frequency [Hz].
    """

    leg: Leg
    seconds: float = 30.0
    rate: float = 200.0
    seed: int = 0
    sideways: float = 0.0
    pitch: float = 0.12
    frequency: float = 0.9

    @property
    def time(self) -> Array:
        """Time stamps [s]."""
        return np.arange(round(self.seconds * self.rate)) / self.rate

    def waves(self, amplitude: float, frequency: float, which: int) -> Array:
        """A sum of sines with its derivatives, (3, N)."""
        phases = np.random.default_rng([self.seed, which]).uniform(0.0, 2.0 * np.pi, len(SHARES))
        w = 2.0 * np.pi * frequency * self.frequency * SHARES[:, None]
        at = w * self.time + phases[:, None]
        parts = np.array([np.sin(at), w * np.cos(at), -(w**2) * np.sin(at)])
        return np.asarray(amplitude * np.einsum("k,dkn->dn", SIZES, parts))

    @property
    def joints(self) -> tuple[Array, Array, Array]:
        """q, v, a, (N, n) each."""
        waves = [self.waves(0.35 / (1.0 + 0.3 * j), 1.0 + 0.1 * j, j) for j in range(len(self.leg.joint_names))]
        q, v, a = np.stack(waves, axis=2)
        return q, v, a

    @property
    def pose(self) -> tuple[Array, Rotation]:
        """Position of the origin of the root link [m], (N, 3), and its orientation."""
        forward, side, up = (self.waves(size, 1.0, 20 + k)[0] for k, size in enumerate((0.05, self.sideways / 2, 0.02)))
        yaw, pitch, roll = (
            self.waves(size, 0.8, 30 + k)[0] for k, size in enumerate((self.sideways, self.pitch, self.sideways))
        )
        return np.column_stack([forward, side, up]), Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll]))

    @property
    def base(self) -> BaseKinematics:
        """Motion of the base, by splines through finely spaced angles and positions."""
        position, turn = self.pose
        p = CubicSpline(self.time, position)
        yaw, pitch, roll = turn.as_euler("ZYX").T
        rates = CubicSpline(self.time, np.column_stack([yaw, pitch, roll]))(self.time, 1).T
        omega = np.column_stack(
            [
                rates[2] - rates[0] * np.sin(pitch),
                rates[1] * np.cos(roll) + rates[0] * np.cos(pitch) * np.sin(roll),
                -rates[1] * np.sin(roll) + rates[0] * np.cos(pitch) * np.cos(roll),
            ]
        )
        force = turn.inv().apply(p(self.time, 2) + np.array([0.0, 0.0, 9.81]))
        return BaseKinematics(omega, CubicSpline(self.time, omega)(self.time, 1), force)

    def recording(self, noise: float = 1.0) -> Recording:
        """Log with noise of all sensors, torques by Pinocchio of the whole motion in space."""
        rng = np.random.default_rng([self.seed, 99])
        (q, v, a), base = self.joints, self.base

        def noisy(x: Array, std: float | Array) -> Array:
            return np.asarray(x + noise * std * rng.standard_normal(x.shape))

        tau = self.leg.inverse_dynamics(q, v, a, base)
        return Recording(
            self.time,
            noisy(q, ANGLE_NOISE),
            tau=noisy(tau, np.resize(TORQUE_NOISE, q.shape[1])),
            joint_names=self.leg.joint_names,
            base=BaseMotion.from_imu(
                noisy(base.angular_velocity, GYRO_NOISE), noisy(base.specific_force_at(IMU), FORCE_NOISE), position=IMU
            ),
        )
