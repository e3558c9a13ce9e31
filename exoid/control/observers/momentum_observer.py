"""Observer of the wearer's torque by generalised momentum, with a filter of first order."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import Dialect, LawInC

from .alignment import JointFilters
from .in_c import observer_in_c
from .observer import TorqueObserver


@dataclass(frozen=True, eq=False, repr=False)
class MomentumObserver(TorqueObserver):
    """r = K (p − ∫ (τ + Cᵀv − G − springs − friction + r) dt) with p = M(q) v (De Luca and Mattone 2003).

    So ṙ = K (τ_wearer − r): the torque of the wearer, smoothed with time constant 1/K. The discrete filter is exact for
    torques that are constant over each interval, r_k = e^{−KT} r_{k−1} + (1 − e^{−KT}) τ̄_k with τ̄ of
    :class:`TorqueObserver`. It is stable for every K and rate, and its impulse response is positive, so that a bounded
    error of friction stays within its filtered bound.

    See :class:`TorqueObserver` for the settings.

    Example:
        >>> import exoid
        >>> data = exoid.datasets.bleex_swing()
        >>> observer = MomentumObserver(exoid.identify(data.leg, data.train), bandwidth=16.0, rate=100.0)
        >>> observer
        MomentumObserver(left_hip, left_knee, left_ankle: 16 Hz at 100 Hz, delay 20.5 ms)
    """

    @property
    def gain(self) -> FloatArray:
        """Gain K = 2π times the bandwidth [1/s], (n,)."""
        return 2.0 * np.pi * self.bandwidths

    @cached_property
    def filters(self) -> JointFilters:
        """(1 − e^{−KT}) / (1 − e^{−KT} z⁻¹)."""
        pole = np.exp(-self.gain / self.rate)
        none = np.zeros_like(pole)
        return JointFilters(np.stack([-np.expm1(-self.gain / self.rate), none]), np.stack([none + 1.0, -pole]))

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the observer in C."""
        return observer_in_c(
            self,
            dialect,
            equation="torque of the wearer = K (p - integral of (tau_m + C'v - G(q) - springs(q) - F(v) + torque of "
            "the wearer)), p = M(q) v",
            filtered="        tau[j] = {{p}}_b[j] * mean + state->filtered[j];\n"
            "        state->filtered[j] = {{p}}_pole[j] * tau[j];",
            tables={
                "b": (self.filters.b[0], "gain of the observer, 1 - exp(-K T)"),
                "pole": (-self.filters.a[1], "exp(-K T)"),
            },
            memory={"filtered": "memory of the observer [N m]"},
        )
