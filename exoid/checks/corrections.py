"""Recordings with a fault taken out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.signals import Poses, Recording

CORRECTED = ("torque-delay", "torque-scale", "angle-offset", "angle-scale", "gravity-direction")
"""Kinds of fault that can be taken out of a recording; that of gravity in a planar leg only."""


def corrected(data: Recording | Poses, kind: str, joint: int, delta: float) -> Recording | Poses:
    """Take a fault out of a recording.

    Args:
        data: The recording, with the joints of the leg.
        kind: Kind of the fault.
        joint: Index of the joint; −1 for all.
        delta: Size of the fault.

    Returns:
        The recording as it would be without the fault.
    """
    joints = range(len(data.joint_names)) if joint < 0 else (joint,)
    if kind == "torque-delay":
        return data if isinstance(data, Poses) else without_delay(data, dict.fromkeys(joints, delta))
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


def without_delay(recording: Recording, delays: dict[int, float]) -> Recording:
    """Shift torques against the motion.

    Args:
        recording: A recording with even time stamps.
        delays: Time by which the torque of each joint is late [s], by its index.

    Returns:
        The recording with torques at t + delay; the first or last value fills the end.
    """
    if recording.tau is None:
        return recording
    even = recording.resampled()
    assert even.tau is not None
    tau = even.tau.copy()
    for joint, delay in delays.items():
        at = np.clip(even.time + delay, even.time[0], even.time[-1])
        tau[:, joint] = scipy.interpolate.CubicSpline(even.time, even.tau[:, joint])(at)
    return replace(even, tau=tau)


def _scaled(x: FloatArray, joint: int, factor: float) -> FloatArray:
    """Multiply the column of one joint."""
    out = np.array(x)
    out[:, joint] *= factor
    return out
