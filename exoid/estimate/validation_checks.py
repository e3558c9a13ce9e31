"""Findings of a validation: motion beyond that of the training, and torque that is not predicted."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import FloatArray
from exoid.findings import Finding

from .data import EstimateData
from .motion_ranges import MotionRanges

BEYOND = 1.3
"""A speed or acceleration so many times larger than in the training is an extrapolation,"""

ANGLE = 0.2
"""and an angle that goes beyond the training's range by this part of the range."""

POOR, USELESS = 0.5, 1.0
"""NRMSE beyond which a prediction is poor, and worse than a constant torque."""


def extrapolations(estimate: EstimateData, ranges: MotionRanges, source: str = "") -> Iterator[Finding]:
    """Find joints that move further, faster or more abruptly than in the training.

    Args:
        estimate: The estimate, with the ranges of its training.
        ranges: Ranges of the recording that is predicted.
        source: Name of the recording.

    Yields:
        One finding for each joint and quantity.
    """
    trained = estimate.ranges
    if trained is None:
        return
    span = np.maximum(trained.highest - trained.lowest, 1e-9)
    outside = np.maximum(trained.lowest - ranges.lowest, ranges.highest - trained.highest) / span
    for k, joint in enumerate(estimate.joint_names):
        sizes = (
            ("angle", float(1.0 + outside[k]), 1.0 + ANGLE),
            ("speed", float(ranges.speed[k] / max(trained.speed[k], 1e-9)), BEYOND),
            ("acceleration", float(ranges.acceleration[k] / max(trained.acceleration[k], 1e-9)), BEYOND),
        )
        for quantity, ratio, limit in sizes:
            if ratio > limit:
                yield Finding(
                    "extrapolation",
                    joint,
                    ratio,
                    "1",
                    "warning",
                    f"the {quantity} goes to {ratio:.3g} times that of the training: the prediction and its band are "
                    "not supported by data there",
                    "identify from a recording that reaches as far",
                    recording=source,
                )


def poor_predictions(estimate: EstimateData, nrmse: FloatArray, source: str = "") -> Iterator[Finding]:
    """Find joints whose torque is predicted badly.

    Args:
        estimate: The estimate.
        nrmse: RMSE of each joint over the standard deviation of its torque, (n,).
        source: Name of the recording.

    Yields:
        One finding for each joint.
    """
    for joint, error in zip(estimate.joint_names, nrmse, strict=True):
        if np.isfinite(error) and error > POOR:
            worse = "; a constant torque would predict it better" if error > USELESS else ""
            yield Finding(
                "large-residual",
                joint,
                float(error),
                "1",
                "error" if error > USELESS else "warning",
                f"the estimate leaves {error:.0%} of the torque unexplained{worse}",
                "check signs, units and joints of this recording, and whether the leg has changed (exoid check)",
                recording=source,
            )
