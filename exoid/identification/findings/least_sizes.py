"""Least size of each kind of fault that is worth a finding, however exact the log."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .nuisances import Nuisance

LEAST_SIZES = {
    "torque-delay": 5e-4,
    "torque-scale": 5e-3,
    "angle-scale": 2e-3,
    "angle-offset": float(np.deg2rad(0.2)),
    "gravity-direction": float(np.deg2rad(0.2)),
    "segment-length": 5e-3,
    "clock": 1e-3,
    "cross-talk": 5e-3,
    "moment-arm": 3e-4,
}
"""Faults below these sizes are not reported, in the unit of the finding: [s], [rad], or a part."""

LEAST_TORQUE = 3e-3
"""Nor is friction or a force whose RMS torque is below this part of the joint's RMS torque,"""

LEAST_SHARE = 5e-3
"""nor are impossible parameters that lie less than this part of a joint's torque from possible ones."""

SEVERE_SHARE = 0.02
"""A fault is an error only if it moves some parameter by this part of a joint's torque."""


def is_large_enough(nuisance: Nuisance, delta: FloatArray, torque_share: float) -> bool:
    """Say whether a fault has a size that matters."""
    least = LEAST_SIZES.get(nuisance.kind)
    if least is None:
        return torque_share >= LEAST_TORQUE
    size = np.abs(delta).max() if nuisance.kind == "cross-talk" else np.linalg.norm(delta)
    return bool(size >= least)
