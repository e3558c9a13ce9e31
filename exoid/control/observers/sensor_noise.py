"""Noise of the sensors that an observer reads, given or measured from a log."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.signals import Recording

ENCODER = 6.0**-0.5
"""Noise of an encoder for an observer over its step, √2 times the 1/√12 of a uniform error.

The error of an encoder is not white: where the speed is nearly a whole number of steps a sample, it changes slowly, and
most of it passes the filters. At 1 kHz and a bandwidth of 10 Hz, readings then reach 6 deviations of white noise.
"""


@dataclass(frozen=True)
class SensorNoise:
    """White noise of each channel at the observer's rate, one number for all joints or (n,).

    Attributes:
        torque: Standard deviation of torques [N·m].
        velocity: Standard deviation of measured velocities [rad/s].
        angle: Standard deviation of angles [rad], which matters where velocities are derived from them; for encoders
            :data:`ENCODER` times their step.

    Raises:
        ExoidError: A standard deviation is negative or not finite.
    """

    torque: ArrayLike
    velocity: ArrayLike = 0.0
    angle: ArrayLike = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("torque", "velocity", "angle"):
            values = np.asarray(getattr(self, name), dtype=np.float64)
            if not np.isfinite(values).all() or (values < 0.0).any() or values.ndim > 1:
                raise BadArgumentError(
                    f"{name} noise of {getattr(self, name)}", remedy="give standard deviations ≥ 0 in SI units"
                )

    @classmethod
    def of(cls, recording: Recording) -> SensorNoise:
        """Measure the noise of a log by fourth differences, which leave almost nothing of a motion.

        The standard deviation of white noise is the RMS of the fourth difference over √70. What changes within four
        samples counts as noise, so that slow logs give too much rather than too little. Angles in whole steps come from
        encoders, see :data:`ENCODER`.

        Args:
            recording: A log at the observer's rate, not filtered.

        Returns:
            The noise.

        Raises:
            ExoidError: The log has no torque, or time steps are uneven.
        """
        if recording.tau is None or not recording.is_uniform:
            raise UnreadableInputError(
                "noise is measured from evenly sampled torques", remedy="give a log as it was sampled"
            )
        tau = _white(recording.tau)
        velocity = 0.0 if recording.v is None else _white(recording.v)
        steps = np.array([_step(q) for q in recording.q.T])
        return cls(tau, velocity, np.maximum(_white(recording.q), ENCODER * steps))


def noise_columns(noise: SensorNoise, n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Spread the standard deviations of torque, velocity and angle over the joints, (n,) each."""
    given = [np.asarray(x, dtype=np.float64) for x in (noise.torque, noise.velocity, noise.angle)]
    if any(x.shape not in ((), (n,)) for x in given):
        raise BadArgumentError(f"{noise} does not fit {n} joints", remedy="give one number, or one for each joint")
    torque, velocity, angle = (np.broadcast_to(x, n).copy() for x in given)
    return torque, velocity, angle


def _step(q: FloatArray) -> float:
    """Step of an encoder whose angles are q, (N,); 0 if they do not come in whole steps."""
    changes = np.abs(np.diff(q))
    changes = changes[changes > 1e-9]  # below is rounding
    if not len(changes):
        return 0.0
    counts = changes / changes.min()
    return float(changes.min()) if np.abs(counts - np.rint(counts)).max() < 1e-3 else 0.0


def _white(x: FloatArray) -> FloatArray:
    """Standard deviation of white noise by fourth differences, whose variance is 1 + 16 + 36 + 16 + 1 = 70 times it."""
    return np.asarray(np.sqrt(np.mean(np.diff(x, 4, axis=0) ** 2, axis=0) / 70.0))
