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
    """Ranges of angle, speed and acceleration of each joint.

    Attributes:
        lowest: Smallest angle [rad], (n,).
        highest: Largest angle [rad], (n,).
        speed: Largest speed [rad/s], (n,).
        acceleration: Largest size of the acceleration [rad/s²], (n,).
    """

    lowest: FloatArray
    highest: FloatArray
    speed: FloatArray
    acceleration: FloatArray

    @classmethod
    def of(cls, q: FloatArray, v: FloatArray, a: FloatArray) -> MotionRanges:
        """Measure the ranges of a motion, without the outermost thousandth of the samples.

        Args:
            q: Angles [rad], (N, n).
            v: Velocities [rad/s], (N, n).
            a: Accelerations [rad/s²], (N, n).

        Returns:
            The ranges.
        """
        lowest, highest = np.quantile(q, [SPREAD, 1.0 - SPREAD], axis=0)
        speed, acceleration = (np.quantile(np.abs(x), 1.0 - SPREAD, axis=0) for x in (v, a))
        return cls(lowest, highest, speed, acceleration)

    def joined(self, other: MotionRanges) -> MotionRanges:
        """Return the ranges of two motions together.

        Args:
            other: Ranges of the other motion.

        Returns:
            The ranges that contain both.
        """
        return MotionRanges(
            np.minimum(self.lowest, other.lowest),
            np.maximum(self.highest, other.highest),
            np.maximum(self.speed, other.speed),
            np.maximum(self.acceleration, other.acceleration),
        )


KEYS = {"lowest": "lowest_angle", "highest": "highest_angle", "speed": "speed", "acceleration": "acceleration"}
"""Keys of the ranges in a file, by attribute."""


def ranges_to_json(ranges: MotionRanges | None, joints: Sequence[str]) -> dict[str, dict[str, float]]:
    """Turn ranges into a JSON object.

    Args:
        ranges: The ranges; None for none.
        joints: Names of the joints, (n,).

    Returns:
        Ranges of each joint by its name; empty for none.
    """
    if ranges is None:
        return {}
    return {
        joint: {key: float(getattr(ranges, name)[k]) for name, key in KEYS.items()} for k, joint in enumerate(joints)
    }


def ranges_from_json(data: Mapping[str, Mapping[str, Any]] | None, joints: Sequence[str]) -> MotionRanges | None:
    """Read ranges that :func:`ranges_to_json` wrote.

    Args:
        data: The JSON object; None in files of exoid 0.1.
        joints: Names of the joints, (n,).

    Returns:
        The ranges; None where there are none.
    """
    if not data:
        return None
    arrays = {name: np.array([data[joint][key] for joint in joints], dtype=np.float64) for name, key in KEYS.items()}
    return MotionRanges(**arrays)
