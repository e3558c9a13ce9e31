"""Sensors: what a log shows of the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError


@dataclass(frozen=True)
class Sensors:
    """Encoders or potentiometers, tachometers and torque sensors of a rig.

    Noise, offset and resolution are a number each, or (n,).

    Attributes:
        encoder_counts: Per turn of the joint; inf for an exact angle.
        angle_noise: Standard deviation, as of a potentiometer [rad].
        velocity_noise: Standard deviation [rad/s].
        torque_noise: Standard deviation [N·m].
        torque_offset: Zero of the torque sensor [N·m].
        torque_resolution: Step of its converter [N·m]; 0 for none.
        delay: Periods of the controller by which all readings are late.
        alike: Blocks of rigs, as many in each: rig k has the same noise in all, for comparisons that chance does not
            blur.

    Raises:
        ExoidError: A number is not finite (but for ``encoder_counts``) or of the wrong sign.
    """

    encoder_counts: float = 2.0**16
    angle_noise: ArrayLike = 0.0
    velocity_noise: ArrayLike = 0.0
    torque_noise: ArrayLike = 0.0
    torque_offset: ArrayLike = 0.0
    torque_resolution: ArrayLike = 0.0
    delay: int = 0
    alike: int = 1

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive = ("angle_noise", "velocity_noise", "torque_noise", "torque_resolution")
        for name in (*positive, "torque_offset"):
            values = np.asarray(getattr(self, name), dtype=np.float64)
            if not np.isfinite(values).all() or (name in positive and (values < 0.0).any()):
                raise ExoidError(f"{name} of the sensors is {getattr(self, name)}", remedy="give finite SI numbers ≥ 0")
        if not self.encoder_counts > 0.0:
            raise ExoidError(f"an encoder of {self.encoder_counts:g} counts", remedy="give counts per turn, or inf")
        if self.delay != int(self.delay) or self.delay < 0:
            raise ExoidError(f"a delay of {self.delay} periods", remedy="give a whole number ≥ 0")
        if self.alike != int(self.alike) or self.alike < 1:
            raise ExoidError(f"{self.alike} blocks of rigs alike", remedy="give a whole number ≥ 1")

    def angle(self, q: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Read angles [rad], (n, B)."""
        noisy = q + self._noise(self.angle_noise, q, rng) if np.any(self.angle_noise) else q
        if np.isinf(self.encoder_counts):
            return noisy
        count = 2.0 * np.pi / self.encoder_counts
        return np.asarray(np.rint(noisy / count) * count)

    def velocity(self, v: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Read velocities [rad/s], (n, B)."""
        return v + self._noise(self.velocity_noise, v, rng) if np.any(self.velocity_noise) else v

    def torque(self, tau: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Read torques [N·m], (n, B)."""
        read = tau + _column(self.torque_offset) + self._noise(self.torque_noise, tau, rng)
        step = _column(self.torque_resolution)
        return np.asarray(np.where(step > 0.0, np.rint(read / np.where(step > 0.0, step, 1.0)) * step, read))

    def _noise(self, std: ArrayLike, like: FloatArray, rng: np.random.Generator) -> FloatArray:
        joints, rigs = like.shape
        if rigs % self.alike:
            raise ExoidError(f"{rigs} rigs in {self.alike} blocks alike", remedy="give as many rigs to each block")
        return np.asarray(_column(std) * np.tile(rng.standard_normal((joints, rigs // self.alike)), self.alike))


def _column(value: ArrayLike) -> FloatArray:
    """One value a joint as a column, so that it spreads over rigs."""
    return np.asarray(value, dtype=np.float64).reshape(-1, 1)
