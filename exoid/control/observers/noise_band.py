"""Noise of an observer's reading: variance by the sensors, and the threshold that it crosses so rarely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate

from .alignment import Alignment
from .false_alarms import threshold
from .joint_filters import JointFilters
from .sensor_noise import SensorNoise


class Residual(NamedTuple):
    """Residual of an identification as noise of the torque balance, (n,) each."""

    variance: FloatArray  # variance of the residuals, behind the filter of the identification [N²·m²]
    density: FloatArray  # two-sided power spectral density of white noise with these residuals [N²·m²/Hz]
    share: float  # share of white torque noise that this filter left, of its variance

    @classmethod
    def of(cls, estimate: Estimate) -> Residual:
        """Read the residual of an estimate."""
        lost = (estimate.dof + len(estimate.values)) / estimate.dof
        variance = lost * estimate.residual_rms**2
        if estimate.model_error is not None:
            variance = estimate.model_error.noise(variance)
        if not estimate.inputs:
            return cls(variance, variance, 1.0)
        rate = min(given.sample_rate for given in estimate.inputs)
        share = estimate.preparation.independent_fraction(rate)
        return cls(variance, variance / (share * rate), share)


@dataclass(frozen=True, eq=False)
class NoiseBand:
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
        residual: Residual | None,
        false_alarms: float,
    ) -> NoiseBand:
        """Compute the gains of the observer's filters."""
        n, rate = alignment.n, alignment.rate
        responses = filtered_noise(alignment, filters)
        gains = [(h**2).sum(axis=0) for h in responses]
        if noise is None:
            white = (
                np.zeros(n) if residual is None else np.maximum(gains[0] * residual.density * rate, residual.variance)
            )
            return cls(white, np.zeros((2, n)), np.zeros((2, n)), np.full(n, np.inf))
        of_torque, of_velocity, of_angle = (std**2 for std in noise.columns(n))
        left = np.zeros(n) if residual is None else residual.variance - residual.share * of_torque
        variances = (of_torque, of_velocity, of_angle)
        acting = [h for h, found in zip(responses, variances, strict=True) if found.any()]
        return cls(
            gains[0] * of_torque + np.clip(left, 0.0, None),
            np.stack([gains[1], of_velocity]),
            np.stack([gains[2], of_angle]),
            _levels(acting or responses[:1], false_alarms, rate),
        )

    def variance(self, M: FloatArray, *, derived: bool) -> FloatArray:
        """Variance of the reading."""
        gain, of_sensor = self.derived if derived else self.velocity
        return np.asarray(self.torque + gain * (M**2 @ of_sensor))


def filtered_noise(alignment: Alignment, filters: JointFilters) -> list[FloatArray]:
    """Impulse responses from noise of torques, measured velocities and angles to the reading, for M = 1."""
    one = np.array([1.0])
    smoothed, slope = (one, one) if alignment.filters is None else (_first(f, one) for f in alignment.filters)
    halves, steps = np.array([0.5, 0.5]), np.array([alignment.rate, -alignment.rate])
    pairs = ((smoothed, halves), (smoothed, steps), (slope, steps))
    return [filters.impulse_response(np.convolve(a, b)) for a, b in pairs]


def effective_share(responses: list[FloatArray]) -> FloatArray:
    """Independent samples that say as much on the size of filtered noise as one of its, the fewest of several kinds."""
    shares = []
    for response in responses:
        spectrum = np.abs(np.fft.rfft(response, 2 * len(response), axis=0)) ** 2
        shares.append(spectrum.mean(axis=0) ** 2 / (spectrum**2).mean(axis=0))
    return np.asarray(np.min(shares, axis=0))


def _first(filters: JointFilters, x: FloatArray) -> FloatArray:
    return filters.impulse_response(x)[:, 0]


def _levels(responses: list[FloatArray], false_alarms: float, rate: float) -> FloatArray:
    """Threshold of each joint for the noise that crosses most often, (n,)."""
    n = responses[0].shape[1]
    correlations = [(h[1:] * h[:-1]).sum(axis=0) / (h**2).sum(axis=0) for h in responses]
    return np.array([threshold(false_alarms / n, float(rho), rate) for rho in np.min(correlations, axis=0)])
