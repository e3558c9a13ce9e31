"""Causal filter of a leg's motion: angles, velocities and accelerations with the same delay."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .law import refuse_rate


class FilteredMotion(NamedTuple):
    """Memory of the filter, which contains the filtered motion, (n,) or (n, B) each."""

    q: FloatArray  # filtered angles [rad]
    rate: FloatArray  # rate of change of the filtered angles [rad/s]
    v: FloatArray  # filtered velocities [rad/s]
    a: FloatArray  # rate of change of the filtered velocities: accelerations, with the same delay [rad/s²]
    q_read: FloatArray  # last reading of the angles [rad]
    v_read: FloatArray  # last reading of the velocities [rad/s]


@dataclass(frozen=True)
class MotionFilter:
    """Low-pass filter λ² / (s + λ)² of angles and velocities, whose states also give the accelerations."""

    # The step is exact for readings that change linearly over each period T. With a channel x, its rate y, the
    # slope m of its reading u, z = x − u + 2m/λ and w = y − m:
    #
    #     z⁺ = e^{−λT} [(1 + λT) z + T w],      w⁺ = e^{−λT} [(1 − λT) w − λ²T z].
    #
    # The filter has no overshoot and no resonance: its gain is at most 1 at every frequency, from the mean acceleration
    # of a period to the filtered one too. Every channel is late by `delay`.

    bandwidth: float  # frequency of half the power [Hz]
    rate: float  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check bandwidth and rate."""
        refuse_rate(self.rate)
        if not 0.0 < self.bandwidth < 0.5 * self.rate:
            raise BadArgumentError(
                f"a filter of {self.bandwidth:g} Hz at {self.rate:g} Hz",
                remedy=f"give a bandwidth between 0 and {0.5 * self.rate:g} Hz, or a higher rate",
            )

    @property
    def pole(self) -> float:
        """Pole λ [1/s]."""
        # 1 / (1 + jω/λ)² has half the power where (ω/λ)² = √2 − 1
        return 2.0 * np.pi * self.bandwidth / float(np.sqrt(np.sqrt(2.0) - 1.0))

    @property
    def delay(self) -> float:
        """Delay 2/λ of slow motion [s]."""
        return 2.0 / self.pole

    def begin(self, q: FloatArray, v: FloatArray) -> FilteredMotion:
        """Begin as if the leg had moved with constant velocity until the first sample."""
        before = q - v / self.rate
        return FilteredMotion(before - self.delay * v, v, v, np.zeros_like(v), before, v)

    def step(self, motion: FilteredMotion, q: FloatArray, v: FloatArray) -> FilteredMotion:
        """Filter a sample."""
        angles = self._channel(motion.q, motion.rate, motion.q_read, q)
        return FilteredMotion(*angles, *self._channel(motion.v, motion.a, motion.v_read, v), q, v)

    def tables_in_c(self) -> dict[str, tuple[float, str]]:
        """Constants of the filter in C: numbers and comments by name."""
        step = self.pole / self.rate
        return {
            "filter_delay": (self.delay, "delay 2/lambda of the motion filter [s]"),
            "filter_rate": (self.rate, "sampling rate [Hz]"),
            "filter_zz": (np.exp(-step) * (1.0 + step), "exp(-lambda T) (1 + lambda T)"),
            "filter_zw": (np.exp(-step) / self.rate, "exp(-lambda T) T [s]"),
            "filter_wz": (-np.exp(-step) * self.pole * step, "-exp(-lambda T) lambda^2 T [1/s]"),
            "filter_ww": (np.exp(-step) * (1.0 - step), "exp(-lambda T) (1 - lambda T)"),
        }

    def _channel(
        self, x: FloatArray, y: FloatArray, before: FloatArray, u: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        step, period, slope = self.pole / self.rate, 1.0 / self.rate, (u - before) * self.rate
        late, decay = self.delay * slope, float(np.exp(-step))
        z, w = x - before + late, y - slope
        z_next = decay * ((1.0 + step) * z + period * w)
        w_next = decay * ((1.0 - step) * w - self.pole * step * z)
        return u - late + z_next, slope + w_next
