"""Sensors: from the true motion and torque to readings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked


@dataclass(frozen=True)
class Sensors:
    """Encoders or potentiometers, tachometers and torque sensors of a rig.

    Noise and offset are one number for all joints, or (n,).

    Attributes:
        encoder_counts: Encoder counts per turn of the joint; inf for an exact angle.
        angle_noise: Standard deviation of the angle, as of a potentiometer [rad].
        velocity_noise: Standard deviation of the velocity [rad/s].
        torque_noise: Standard deviation of the torque [N·m].
        torque_offset: Zero offset of the torque sensor [N·m].
        delay: Delay of all readings in periods of the controller.

    Raises:
        ExoidError: A number has the wrong sign, or is not finite (``encoder_counts`` may be infinite).
    """

    encoder_counts: float = 2.0**16
    angle_noise: ArrayLike = 0.0
    velocity_noise: ArrayLike = 0.0
    torque_noise: ArrayLike = 0.0
    torque_offset: ArrayLike = 0.0
    delay: int = 0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("angle_noise", "velocity_noise", "torque_noise"):
            checked(getattr(self, name), name, least=0.0)
        checked(self.torque_offset, "torque_offset")
        checked(self.encoder_counts, "encoder_counts", above=0.0, infinite=True)
        if self.delay != int(self.delay) or self.delay < 0:
            raise BadArgumentError(f"a delay of {self.delay} periods", remedy="give a whole number ≥ 0")


def read_angle(sensors: Sensors, q: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Read angles of B rigs."""
    read = noisy(q, _column(sensors.angle_noise), rng) if np.any(sensors.angle_noise) else q
    if np.isinf(sensors.encoder_counts):
        return read
    count = 2.0 * np.pi / sensors.encoder_counts
    return np.asarray(np.rint(read / count) * count)


def read_velocity(sensors: Sensors, v: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Read velocities of B rigs."""
    return noisy(v, _column(sensors.velocity_noise), rng) if np.any(sensors.velocity_noise) else v


def read_torque(sensors: Sensors, tau: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Read torques of B rigs."""
    return noisy(tau + _column(sensors.torque_offset), _column(sensors.torque_noise), rng)


def noisy(x: FloatArray, std: float | FloatArray, rng: np.random.Generator) -> FloatArray:
    """Add white noise, of one size or of sizes that broadcast."""
    return np.asarray(x + std * rng.standard_normal(x.shape))


def _column(value: ArrayLike) -> FloatArray:
    """Shape one value, or one a joint, as a column that broadcasts over rigs."""
    return np.asarray(value, dtype=np.float64).reshape(-1, 1)
