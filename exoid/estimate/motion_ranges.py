"""Ranges of the motion that an estimate was fitted to, and what goes beyond them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

SPREAD = 1.0 / 1000.0
"""Share of the samples at each end of a range that may be outliers."""


@dataclass(frozen=True, eq=False)
class MotionRanges:
    """Ranges of angle, speed and acceleration of each joint."""

    lowest: FloatArray  # smallest angle [rad], (n,)
    highest: FloatArray  # largest angle [rad], (n,)
    speed: FloatArray  # largest speed [rad/s], (n,)
    acceleration: FloatArray  # largest size of the acceleration [rad/s²], (n,)

    @classmethod
    def of(cls, q: FloatArray, v: FloatArray, a: FloatArray) -> MotionRanges:
        """Measure the ranges of a motion, without the outermost thousandth of the samples."""
        lowest, highest = np.quantile(q, [SPREAD, 1.0 - SPREAD], axis=0)
        speed, acceleration = (np.quantile(np.abs(x), 1.0 - SPREAD, axis=0) for x in (v, a))
        return cls(lowest, highest, speed, acceleration)

    def joined(self, other: MotionRanges) -> MotionRanges:
        """Return the ranges of two motions together."""
        return MotionRanges(
            np.minimum(self.lowest, other.lowest),
            np.maximum(self.highest, other.highest),
            np.maximum(self.speed, other.speed),
            np.maximum(self.acceleration, other.acceleration),
        )
