"""Ranges of the motion that an estimate was fitted to, and what goes beyond them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

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


KEYS = {"lowest": "lowest_angle", "highest": "highest_angle", "speed": "speed", "acceleration": "acceleration"}
"""Keys of the ranges in a file, by attribute."""


def ranges_to_json(ranges: MotionRanges | None, joints: Sequence[str]) -> dict[str, dict[str, float]]:
    """Turn ranges into a JSON object."""
    if ranges is None:
        return {}
    return {
        joint: {key: float(getattr(ranges, name)[k]) for name, key in KEYS.items()} for k, joint in enumerate(joints)
    }


def ranges_from_json(data: Mapping[str, Mapping[str, Any]] | None, joints: Sequence[str]) -> MotionRanges | None:
    """Read ranges that :func:`ranges_to_json` wrote."""
    if not data:
        return None
    arrays = {name: np.array([data[joint][key] for joint in joints], dtype=np.float64) for name, key in KEYS.items()}
    return MotionRanges(**arrays)
