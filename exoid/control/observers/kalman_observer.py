"""Kalman filter of momentum and wearer's torque, with the noise of the sensors and of the estimate."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.errors import BadArgumentError, NotIdentifiableError

from .alignment import JointFilters
from .in_c import observer_in_c
from .noise import Residual, noise_columns
from .observer import TorqueObserver


@dataclass(frozen=True, eq=False, repr=False)
class KalmanObserver(TorqueObserver):
    """Steady-state Kalman filter of p_k = p_{k−1} + T (u + τ_wearer) + w with τ_wearer a random walk.

    The momentum p is measured with noise M(0) σ_v; σ_v is that of measured velocities where it is given, otherwise that
    of velocities derived from angles. The noise w of the impulse is that of torques, T σ_τ, or that of the residuals of
    the estimate where it is more. The random walk is such that the response is −3 dB at ``bandwidth``. Each joint has
    its own filter, with gains L from the algebraic Riccati equation:

        e_k = p_k − (p̂ + T (ū_k + τ̂)),    p̂ ← p_k − (1 − L1) e_k,    τ̂ ← τ̂ + L2 e_k,

    so that τ̂ = L2 T τ̄ / (1 − (2 − L1 − T L2) z⁻¹ + (1 − L1) z⁻²), with τ̄ of :class:`TorqueObserver`. Where noise of
    torques dominates it is nearly the filter of :class:`.MomentumObserver`; where noise of velocities does, it is of
    second order with damping 1/√2.

    See :class:`TorqueObserver` for the settings.

    Raises:
        ExoidError: The noise is unknown, or no walk gives the bandwidth.
    """

    @cached_property
    def gain(self) -> FloatArray:
        """Gains L1 [–] of the momentum and L2 [1/s] of the torque, (2, n)."""
        process, measurement = self.noise_variances
        gains = [
            steady_gain(random_walk(frequency, *noise), *noise)
            for frequency, *noise in zip(self.bandwidths / self.rate, process, measurement, strict=True)
        ]
        return np.asarray(np.array(gains).T * np.array([[1.0], [self.rate]]))

    @cached_property
    def filters(self) -> JointFilters:
        """Filter of the balance."""
        L1, L2 = self.gain
        none, step = np.zeros_like(L1), L2 / self.rate
        return JointFilters(np.stack([step, none, none]), np.stack([none + 1.0, L1 + step - 2.0, 1.0 - L1]))

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

    @cached_property
    def noise_variances(self) -> tuple[FloatArray, FloatArray]:
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


def steady_gain(walk: float, process: float, measurement: float) -> FloatArray:
    """Solve the algebraic Riccati equation of p / T and τ, in units of the mean torque of an interval: L1 and T L2."""
    # With the innovations e of variance S, (1 − z⁻¹)² p = (1 − (2 − L1 − T L2) z⁻¹ + (1 − L1) z⁻²) e. Both sides have
    # the same autocovariances, so S (1 − L1) = r and S (T L2)² = w; S + r²/S − 2 r = `less` is a root of a square.
    less = 0.5 * (walk + 2.0 * process + np.sqrt(walk * (walk + 4.0 * process + 16.0 * measurement)))
    root = np.sqrt(less) + np.sqrt(less + 4.0 * measurement)  # 2 √S
    return np.asarray(np.array([2.0 * np.sqrt(less), 2.0 * np.sqrt(walk)]) / root)


def random_walk(frequency: float, process: float, measurement: float) -> float:
    """Find the variance of the torque's change within a sample whose filter is −3 dB at a frequency over the rate."""
    late = np.exp(-2j * np.pi * frequency)

    def excess(power: float) -> float:
        L1, L2 = steady_gain(10.0**power * process, process, measurement)
        return float(np.abs(L2 / (1.0 - (2.0 - L1 - L2) * late + (1.0 - L1) * late**2)) - np.sqrt(0.5))

    lowest, highest = -9.0, 9.0  # powers of ten of the ratio of walk to process noise
    if not excess(lowest) < 0.0 < excess(highest):
        what = f"no walk of the torque gives a bandwidth of {frequency:.3g} times the rate"
        raise BadArgumentError(what, remedy="give another bandwidth")
    return float(10.0 ** scipy.optimize.brentq(excess, lowest, highest) * process)
