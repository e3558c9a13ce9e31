"""Noise of the sensors that an observer reads, and the band of a reading by noise and parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import UnreadableInputError
from exoid.estimate import Estimate
from exoid.leg.joint_numbers import for_joints
from exoid.signals import Recording
from exoid.tools.numbers import checked

from .alignment import Alignment, JointFilter

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
            checked(getattr(self, name), f"{name} noise", least=0.0)

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
            what = "noise is measured from evenly sampled torques"
            raise UnreadableInputError(what, remedy="give a log as it was sampled")
        tau = _white(recording.tau)
        velocity = 0.0 if recording.v is None else _white(recording.v)
        steps = np.array([_step(q) for q in recording.q.T])
        return cls(tau, velocity, np.maximum(_white(recording.q), ENCODER * steps))


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


class NoiseBand(NamedTuple):
    """Variance of a reading by noise: σ_i² = g_τ σ_τ,i² + g_v Σ_j M_ij² σ_v,j² + what the identification left."""

    # Gains g are sums of squared impulse responses, with the mass matrix as slow. Noise of angles enters by the
    # velocity that is derived from them; its part through gravity is neglected.

    torque: FloatArray  # variance by torque noise and by what the identification left [N²·m²], (n,)
    velocity: FloatArray  # g_v times the variance σ_v,j² of each velocity, (n,)
    derived: FloatArray  # the same where velocities are derived from angles, (n,)
    level: float  # threshold in standard deviations

    @classmethod
    def of(
        cls, alignment: Alignment, one: JointFilter, noise: SensorNoise | None, source: object, false_alarms: float
    ) -> NoiseBand:
        """Compute the gains of the observer's filters; an estimate adds what its identification left."""
        n, rate = alignment.n, alignment.rate
        # variance of the residuals behind the filter of the identification, the share of white noise that this filter
        # left, and the two-sided density of white noise with these residuals [N²·m²/Hz]
        residual, share = source.noise_variance if isinstance(source, Estimate) else np.zeros(n), 1.0
        density = residual
        if isinstance(source, Estimate) and source.inputs:
            slowest = min(given.sample_rate for given in source.inputs)
            share = source.preparation.independent_fraction(slowest)
            density = residual / (share * slowest)
        smoothed = slope = pulse = np.array([1.0])
        if alignment.filters is not None:
            smoothed, slope = (each.impulse_response(pulse) for each in alignment.filters)
        halves, steps = np.array([0.5, 0.5]), np.array([rate, -rate])
        # impulse responses from noise of torques, measured velocities and angles to the reading, for M = 1
        pairs = ((smoothed, halves), (smoothed, steps), (slope, steps))
        responses = [one.impulse_response(np.convolve(a, b)) for a, b in pairs]
        gains = [float(h @ h) for h in responses]
        if noise is None:  # the band of the residuals alone, without detection
            white = np.maximum(gains[0] * density * rate, residual)
            return cls(white, np.zeros(n), np.zeros(n), np.inf)
        variances = [for_joints(x, n, "noise") ** 2 for x in (noise.torque, noise.velocity, noise.angle)]
        left = np.clip(residual - share * variances[0], 0.0, None)
        acting = [h for h, found in zip(responses, variances, strict=True) if found.any()] or responses[:1]
        # the kind of noise that crosses most often decides
        rho = min(float(h[1:] @ h[:-1] / (h @ h)) for h in acting)
        torque, velocity, derived = (gain * found for gain, found in zip(gains, variances, strict=True))
        return cls(torque + left, velocity, derived, threshold(false_alarms / n, rho, rate))

    def variance(self, M: FloatArray, *, derived: bool) -> FloatArray:
        """Variance of the reading at mass matrices (N, n, n), (N, n)."""
        return np.asarray(self.torque + M**2 @ (self.derived if derived else self.velocity))


def threshold(per_minute: float, correlation: float, rate: float) -> float:
    """Level in standard deviations that Gaussian noise crosses outwards so often, both signs; 0 if it never does."""
    # A sample below the level u is followed by one above it with probability 2 T(u, √((1 − ρ)/(1 + ρ))), with T Owen's
    # function and ρ the correlation of a sample with the next. For a fine time step this is the formula of Rice (1945),
    # (σ_ẋ / 2π σ_x) exp(−u²/2), which has no limit for the observer's noise in continuous time.
    checked(per_minute, "false alarms per minute", above=0.0)
    held = float(np.clip(correlation, -1.0 + 1e-9, 1.0 - 1e-12))
    slope = np.sqrt((1.0 - held) / (1.0 + held))

    def excess(level: float) -> float:
        crossings = 60.0 * rate * 2.0 * 2.0 * float(scipy.special.owens_t(level, slope))  # per minute
        return float(np.log(max(crossings, 1e-300) / per_minute))

    return 0.0 if excess(0.0) <= 0.0 else float(scipy.optimize.brentq(excess, 0.0, 30.0))
