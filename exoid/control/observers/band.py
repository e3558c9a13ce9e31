"""Band of a reading: its variance by noise and parameters, and the threshold that noise crosses so rarely."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate

from .alignment import Alignment
from .joint_filters import JointFilters
from .sensor_noise import SensorNoise, noise_columns


class Residual(NamedTuple):
    """Residual of an identification as noise of the torque balance, (n,) each."""

    variance: FloatArray  # variance of the residuals, behind the filter of the identification [N²·m²]
    density: FloatArray  # two-sided power spectral density of white noise with these residuals [N²·m²/Hz]
    share: float  # share of white torque noise that this filter left, of its variance

    @classmethod
    def of(cls, source: object, n: int) -> Residual:
        """Read the residual of an estimate; other models have none."""
        if not isinstance(source, Estimate):
            return cls(np.zeros(n), np.zeros(n), 1.0)
        variance = (source.dof + len(source.values)) / source.dof * source.residual_rms**2
        if source.model_error is not None:
            variance = source.model_error.noise(variance)
        if not source.inputs:
            return cls(variance, variance, 1.0)
        rate = min(given.sample_rate for given in source.inputs)
        share = source.preparation.independent_fraction(rate)
        return cls(variance, variance / (share * rate), share)


class NoiseBand(NamedTuple):
    """Variance of a reading by noise: σ_i² = g_τ σ_τ,i² + g_v Σ_j M_ij² σ_v,j² + what the identification left."""

    # Gains g are sums of squared impulse responses, with the mass matrix as slow. Noise of angles enters by the
    # velocity that is derived from them; its part through gravity is neglected.

    torque: FloatArray  # variance by torque noise and by what the identification left [N²·m²], (n,)
    velocity: FloatArray  # gain g_v,i of each reading, and variance σ_v,j² of each sensor [rad²/s²], (2, n)
    derived: FloatArray  # the same where velocities are derived from angles: gain, and variance of angles [rad²]
    level: FloatArray  # threshold in standard deviations, (n,)

    @classmethod
    def of(
        cls,
        alignment: Alignment,
        filters: JointFilters,
        noise: SensorNoise | None,
        residual: Residual,
        false_alarms: float,
    ) -> NoiseBand:
        """Compute the gains of the observer's filters."""
        responses, n, rate = filtered_noise(alignment, filters), alignment.n, alignment.rate
        gains = [(h**2).sum(axis=0) for h in responses]
        if noise is None:  # the band of the residuals alone, without detection
            white = np.maximum(gains[0] * residual.density * rate, residual.variance)
            return cls(white, np.zeros((2, n)), np.zeros((2, n)), np.full(n, np.inf))
        variances = [std**2 for std in noise_columns(noise, n)]
        left = np.clip(residual.variance - residual.share * variances[0], 0.0, None)
        acting = [h for h, found in zip(responses, variances, strict=True) if found.any()] or responses[:1]
        # the kind of noise that crosses most often decides
        rho = np.min([(h[1:] * h[:-1]).sum(axis=0) / (h**2).sum(axis=0) for h in acting], axis=0)
        level = np.array([threshold(false_alarms / n, float(each), rate) for each in rho])
        velocity, derived = (np.stack(pair) for pair in zip(gains[1:], variances[1:], strict=True))
        return cls(gains[0] * variances[0] + left, velocity, derived, level)

    def variance(self, M: FloatArray, *, derived: bool) -> FloatArray:
        """Variance of the reading at mass matrices (N, n, n), (N, n)."""
        gain, of_sensor = self.derived if derived else self.velocity
        return np.asarray(self.torque + gain * (M**2 @ of_sensor))


def parameter_variance(estimate: Estimate, moved: FloatArray) -> FloatArray:
    """Variance by errors of the parameters and of the model, of filtered columns (N, K, n), (N, n)."""
    rows = moved.transpose(0, 2, 1)
    of_values = rows[..., : len(estimate.values)]
    found = ((of_values @ estimate.covariance) * of_values).sum(-1)
    if estimate.model_error is not None:
        found = found + estimate.model_error.variance(rows)
    return np.asarray(np.clip(found, 0.0, None))


def filtered_noise(alignment: Alignment, filters: JointFilters) -> list[FloatArray]:
    """Impulse responses from noise of torques, measured velocities and angles to the reading, for M = 1."""
    smoothed = slope = one = np.array([1.0])
    if alignment.filters is not None:
        smoothed, slope = (each.impulse_response(one)[:, 0] for each in alignment.filters)
    halves, steps = np.array([0.5, 0.5]), np.array([alignment.rate, -alignment.rate])
    pairs = ((smoothed, halves), (smoothed, steps), (slope, steps))
    return [filters.impulse_response(np.convolve(a, b)) for a, b in pairs]


def crossings_per_minute(level: float, correlation: float, rate: float) -> float:
    """Rate at which Gaussian noise crosses ± ``level`` standard deviations outwards, both signs (Rice 1945)."""
    # A sample below the level u is followed by one above it with probability 2 T(u, √((1 − ρ)/(1 + ρ))), with T Owen's
    # function and ρ the correlation of a sample with the next. For a fine time step this is Rice's formula
    # (σ_ẋ / 2π σ_x) exp(−u²/2), which has no limit for the observer's noise in continuous time.
    slope = np.sqrt((1.0 - correlation) / (1.0 + correlation))
    return float(60.0 * rate * 2.0 * 2.0 * scipy.special.owens_t(level, slope))


def threshold(per_minute: float, correlation: float, rate: float) -> float:
    """Level in standard deviations that noise crosses so often; 0 if it never does."""
    if not 0.0 < per_minute < np.inf:
        raise BadArgumentError(f"{per_minute} false alarms per minute", remedy="give a positive number, such as 1e-3")
    held = float(np.clip(correlation, -1.0 + 1e-9, 1.0 - 1e-12))

    def excess(level: float) -> float:
        return float(np.log(max(crossings_per_minute(level, held, rate), 1e-300) / per_minute))

    return 0.0 if excess(0.0) <= 0.0 else float(scipy.optimize.brentq(excess, 0.0, 30.0))
