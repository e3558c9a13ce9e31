"""Kalman filter of momentum and wearer's torque, with the noise of the sensors and of the estimate."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.errors import BadArgumentError, NotIdentifiableError
from exoid.leg.joint_numbers import for_joints
from exoid.signals import Recording

from .alignment import JointFilters
from .in_c import observer_in_c
from .noise import NoiseBand, Residual, SensorNoise, filtered_noise, noise_columns
from .observer import BLOCK, TorqueObserver
from .readings import observed_log


class InnovationTest(NamedTuple):
    """Whether the innovations of a log are as large as the noise says, (n,) each.

    Attributes:
        ratio: Mean squared innovation over the predicted one; 1 for a leg on which nothing acts and noise as given.
        probability: Probability of so large a ratio, or a larger one, by chance. Small: something acts on the leg, the
            model is wrong, or the noise is larger than given.
        samples: Independent samples that say as much.
    """

    ratio: FloatArray
    probability: FloatArray
    samples: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class KalmanObserver(TorqueObserver):
    """Steady-state Kalman filter of p_k = p_{k−1} + T (u + τ_wearer) + w with τ_wearer a random walk.

    The momentum p is measured with noise M(0) σ_v; σ_v is that of measured velocities where it is given, otherwise that
    of velocities derived from angles. The noise w of the impulse is that of torques, T σ_τ, or that of the residuals of
    the estimate where it is more. The random walk is given by ``drift``, or found so that the response is −3 dB at
    ``bandwidth``. Each joint has its own filter, with gains L from the algebraic Riccati equation:

        e_k = p_k − (p̂ + T (ū_k + τ̂)),    p̂ ← p_k − (1 − L1) e_k,    τ̂ ← τ̂ + L2 e_k,

    so that τ̂ = L2 T τ̄ / (1 − (2 − L1 − T L2) z⁻¹ + (1 − L1) z⁻²), with τ̄ of :class:`TorqueObserver`. Where noise of
    torques dominates it is nearly the filter of :class:`.MomentumObserver`; where noise of velocities does, it is of
    second order with damping 1/√2.

    Attributes:
        drift: Standard deviation of the change of the wearer's torque within a second [N·m/√s], a number or (n,). None
            to take the bandwidth, which may be None otherwise.

    Raises:
        ExoidError: Neither drift nor bandwidth is given, or the noise is unknown.
    """

    bandwidth: ArrayLike | None
    _: KW_ONLY
    drift: ArrayLike | None = None

    def __post_init__(self) -> None:
        """Check the settings."""
        if (self.bandwidth is None) == (self.drift is None):
            raise BadArgumentError(
                "both or none of bandwidth and drift", remedy="give one of them, and None for the other"
            )
        super().__post_init__()

    @cached_property
    def gain(self) -> FloatArray:
        """Gains L1 [–] of the momentum and L2 [1/s] of the torque, (2, n)."""
        return np.asarray(np.array([found.gain for found in self._joints]).T * np.array([[1.0], [self.rate]]))

    @cached_property
    def filters(self) -> JointFilters:
        """Filter of the balance."""
        L1, L2 = self.gain
        none, step = np.zeros_like(L1), L2 / self.rate
        return JointFilters(np.stack([step, none, none]), np.stack([none + 1.0, L1 + step - 2.0, 1.0 - L1]))

    @cached_property
    def steady_std(self) -> FloatArray:
        """Standard deviation of the filter's error for a torque that walks as assumed [N·m], (n,)."""
        return np.array([found.std for found in self._joints])

    @cached_property
    def walk(self) -> FloatArray:
        """Standard deviation of the change of the wearer's torque within a second [N·m/√s], (n,)."""
        return np.asarray(np.sqrt([found.walk * self.rate for found in self._joints]))

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the observer in C, with the gains of the steady state: no Riccati equation is solved there."""
        (b, _, _), (_, a1, a2) = self.filters.b, self.filters.a
        return observer_in_c(
            self,
            dialect,
            equation="torque of the wearer by a steady Kalman filter of p' = tau_m + C'v - G(q) - springs(q) - F(v) + "
            "torque of the wearer, a random walk, p = M(q) v",
            filtered="        tau[j] = {{p}}_b[j] * mean + state->filtered[j];\n"
            "        state->filtered[j] = state->late[j] - {{p}}_a1[j] * tau[j];\n"
            "        state->late[j] = -{{p}}_a2[j] * tau[j];",
            tables={
                "b": (b, "gain of the balance, L2 T"),
                "a1": (a1, "denominator of the filter, L1 + L2 T - 2"),
                "a2": (a2, "denominator of the filter, 1 - L1"),
            },
            memory={
                "filtered": "memory of the observer [N m]",
                "late": "memory of the observer, one sample older [N m]",
            },
        )

    def innovation_test(self, recording: Recording) -> InnovationTest:
        """Compare the innovations of a log with those that noise alone causes.

        Args:
            recording: The log at the observer's rate.

        Returns:
            The test: by chi-squared with as many degrees of freedom as there are independent innovations.

        Raises:
            ExoidError: As :meth:`run`.
        """
        if self.noise is None:
            return replace(self, noise=SensorNoise.of(recording)).innovation_test(recording)
        observed = self.run(recording)
        # the innovation is (1 − z⁻¹) / L2 times the torque
        innovation = np.diff(observed.torque, axis=0)[observed.settling :] / self.gain[1]
        b = np.zeros_like(self.filters.b)
        b[0], b[1] = 1.0 / self.rate, -1.0 / self.rate
        filters = JointFilters(b, self.filters.a)
        band = NoiseBand.of(self.alignment, filters, self.noise, Residual.of(None, self.model.n), self.false_alarms)
        q = observed_log(self.source, recording, self.rate).q[observed.settling + 1 :]
        blocks = (q[start : start + BLOCK] for start in range(0, len(q), BLOCK))
        masses = (self.terms.over(part, np.zeros_like(part)).M for part in blocks)
        squares = innovation**2 / np.concatenate([band.variance(M, derived=recording.v is None) for M in masses])
        # independent samples that say as much on the size of filtered noise, the fewest of several kinds
        spectra = [np.abs(np.fft.rfft(h, 2 * len(h), axis=0)) ** 2 for h in filtered_noise(self.alignment, filters)]
        shares = [spectrum.mean(axis=0) ** 2 / (spectrum**2).mean(axis=0) for spectrum in spectra]
        samples, ratio = len(squares) * np.min(shares, axis=0), squares.mean(axis=0)
        probability = np.asarray(scipy.stats.chi2.sf(ratio * samples, samples))
        return InnovationTest(ratio, probability, samples)

    @cached_property
    def _joints(self) -> list[SteadyState]:
        """Steady state of each joint."""
        process, measurement = self._noise_variances
        if self.drift is None:
            frequencies = self.bandwidths / self.rate
            return [_of_bandwidth(*each) for each in zip(frequencies, process, measurement, strict=True)]
        drift = for_joints(self.drift, self.model.n, "drifts")
        if not ((drift > 0.0) & np.isfinite(drift)).all():
            raise BadArgumentError(f"a drift of {self.drift}", remedy="give positive numbers in N·m/√s")
        walks = drift**2 / self.rate
        return [_steady_state(*each) for each in zip(walks, process, measurement, strict=True)]

    @cached_property
    def _noise_variances(self) -> tuple[FloatArray, FloatArray]:
        """Variances of the mean torque of an interval, by the impulse and by the momentum [N²·m²], (n,) each."""
        n = self.model.n
        residual = Residual.of(self.source, n).density * self.rate
        process, speed = residual, np.zeros(n)
        if self.noise is not None:
            torque, velocity, angle = noise_columns(self.noise, n)
            slope = np.array([self.rate, -self.rate])
            if self.alignment.filters is not None:
                slope = self.alignment.filters[1].impulse_response(np.array([1.0]))[:, 0]
            speed = np.where(velocity > 0.0, velocity**2, angle**2 * (slope**2).sum())
            process = np.maximum(torque**2, residual)
        if not (process > 0.0).all():
            raise NotIdentifiableError(
                "the noise of the torques is unknown, and the model is not an estimate with residuals",
                remedy="give noise=SensorNoise(torque=..., velocity=..., angle=...), or SensorNoise.of(recording)",
            )
        M = self.model.mass_matrix(np.zeros(n))
        return process, np.maximum(M**2 @ speed * self.rate**2, 1e-6 * process)  # at least that of an exact velocity

    @cached_property
    def bandwidths(self) -> FloatArray:
        """−3 dB frequency of the filter of each joint [Hz], (n,)."""
        if self.bandwidth is not None:
            return super().bandwidths
        return np.array([_bandwidth(found.gain) * self.rate for found in self._joints])


class SteadyState(NamedTuple):
    """Steady state of the filter of one joint, in units of the mean torque of a sampling interval."""

    gain: FloatArray  # gains L1 and T L2, (2,)
    std: float  # standard deviation of the torque's error [N·m]
    walk: float  # variance of the torque's change within a sample [N²·m²]


def _steady_state(walk: float, process: float, measurement: float) -> SteadyState:
    """Solve the algebraic Riccati equation of p / T and τ."""
    A, H = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    P = scipy.linalg.solve_discrete_are(A.T, H.T, np.diag([process, walk]), np.array([[measurement]]))
    gain = P[:, 0] / (P[0, 0] + measurement)
    return SteadyState(gain, float(np.sqrt(P[1, 1] - gain[1] * P[0, 1])), walk)


def _response(gain: FloatArray, frequency: float) -> float:
    """Size of the filter's response at a frequency over the sampling rate."""
    late = np.exp(-2j * np.pi * frequency)
    return float(np.abs(gain[1] / (1.0 - (2.0 - gain.sum()) * late + (1.0 - gain[0]) * late**2)))


def _of_bandwidth(frequency: float, process: float, measurement: float) -> SteadyState:
    """Find the walk whose filter is −3 dB at a frequency over the sampling rate."""

    def excess(power: float) -> float:
        found = _steady_state(10.0**power * process, process, measurement)
        return float(_response(found.gain, frequency) - np.sqrt(0.5))

    lowest, highest = -9.0, 9.0  # powers of ten of the ratio of walk to process noise
    if not excess(lowest) < 0.0 < excess(highest):
        what = f"no walk of the torque gives a bandwidth of {frequency:.3g} times the rate"
        raise BadArgumentError(what, remedy="give drift")
    return _steady_state(10.0 ** scipy.optimize.brentq(excess, lowest, highest) * process, process, measurement)


def _bandwidth(gain: FloatArray) -> float:
    """Frequency over the sampling rate at which the filter is −3 dB; a half if it never is."""
    if _response(gain, 0.5) >= np.sqrt(0.5):
        return 0.5
    return float(scipy.optimize.brentq(lambda f: _response(gain, f) - np.sqrt(0.5), 1e-9, 0.5))
