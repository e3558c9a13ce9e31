"""Recordings with a fault taken out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.signals import Poses, Recording, without_torque_delay

CORRECTED = ("torque-delay", "torque-scale", "angle-offset", "angle-scale", "gravity-direction")
"""Kinds of fault that can be taken out of a recording; that of gravity in a planar leg only."""


def corrected(data: Recording | Poses, kind: str, joint: int, delta: float) -> Recording | Poses:
    """Take a fault out of a recording."""
    joints = range(len(data.joint_names)) if joint < 0 else (joint,)
    if kind == "torque-delay":
        return data if isinstance(data, Poses) else without_torque_delay(data, dict.fromkeys(joints, delta))
    q = data.q.copy()
    changes: dict[str, Any] = {}
    for k in joints:
        if kind in ("angle-offset", "gravity-direction"):
            q[:, k] += delta
            changes["q"] = q
        elif kind == "angle-scale":
            for name in ("q", "v", "a"):
                if getattr(data, name, None) is not None:
                    changes[name] = _scaled(changes.get(name, getattr(data, name)), k, 1.0 + delta)
        elif kind == "torque-scale" and data.tau is not None:
            changes["tau"] = _scaled(changes.get("tau", data.tau), k, 1.0 / (1.0 + delta))
    return replace(data, **changes)


def _scaled(x: FloatArray, joint: int, factor: float) -> FloatArray:
    """Multiply the column of one joint."""
    out = np.array(x)
    out[:, joint] *= factor
    return out
