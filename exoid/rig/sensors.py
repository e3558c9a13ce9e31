"""Sensors: from the true motion and torque to readings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError


@dataclass(frozen=True)
class Sensors:
    """Encoders or potentiometers, tachometers, torque sensors, and sensors in the cuffs of a rig.

    Noise and offset are one number for all joints, or (n,).

    Attributes:
        encoder_counts: Encoder counts per turn of the joint; inf for an exact angle.
        angle_noise: Standard deviation of the angle, as of a potentiometer [rad].
        velocity_noise: Standard deviation of the velocity [rad/s].
        torque_noise: Standard deviation of the torque [N·m].
        torque_offset: Zero offset of the torque sensor [N·m].
        delay: Delay of all readings in periods of the controller.
        interaction_noise: Standard deviation of the torque of the wearer that controllers receive [N·m].
        interaction_offset: Zero offset of that torque [N·m].

    Raises:
        ExoidError: A number has the wrong sign, or is not finite (``encoder_counts`` may be infinite).
    """

    encoder_counts: float = 2.0**16
    angle_noise: ArrayLike = 0.0
    velocity_noise: ArrayLike = 0.0
    torque_noise: ArrayLike = 0.0
    torque_offset: ArrayLike = 0.0
    delay: int = 0
    interaction_noise: ArrayLike = 0.0
    interaction_offset: ArrayLike = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive = ("angle_noise", "velocity_noise", "torque_noise", "interaction_noise")
        check_numbers(self, positive)
        check_numbers(self, ("torque_offset", "interaction_offset"), signed=True)
        if not self.encoder_counts > 0.0:
            raise BadArgumentError(
                f"an encoder of {self.encoder_counts:g} counts", remedy="give counts per turn, or inf"
            )
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


def read_interaction(sensors: Sensors, tau: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Read torques of the wearers of B rigs."""
    read = tau + _column(sensors.interaction_offset)
    return (
        noisy(read, _column(sensors.interaction_noise), rng) if np.any(sensors.interaction_noise) else np.asarray(read)
    )


def noisy(x: FloatArray, std: float | FloatArray, rng: np.random.Generator) -> FloatArray:
    """Add white noise, of one size or of sizes that broadcast."""
    return np.asarray(x + std * rng.standard_normal(x.shape))


def _column(value: ArrayLike) -> FloatArray:
    """Shape one value, or one a joint, as a column that broadcasts over rigs."""
    return np.asarray(value, dtype=np.float64).reshape(-1, 1)


def check_numbers(sensors: object, names: Iterable[str], *, signed: bool = False) -> None:
    """Refuse numbers of sensors that are not finite, or negative."""
    for name in names:
        values = np.asarray(getattr(sensors, name), dtype=np.float64)
        if not np.isfinite(values).all() or (not signed and (values < 0.0).any()):
            remedy = "give finite SI numbers ≥ 0"
            raise BadArgumentError(f"{name} of the sensors is {getattr(sensors, name)}", remedy=remedy)
