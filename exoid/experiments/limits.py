"""Refusing poses and motions that a leg cannot follow, before anything runs."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.rig import Reference

TOLERANCE = 1e-9


def refuse_poses_beyond_limits(leg: Leg, poses: FloatArray) -> None:
    """Refuse poses that a joint cannot reach.

    Args:
        leg: With its limits.
        poses: Angles [rad], (K, n).

    Raises:
        ExoidError: Names the pose, the joint and its limits.
    """
    lower, upper, *_ = leg.limits
    beyond = np.argwhere((poses < lower - TOLERANCE) | (poses > upper + TOLERANCE) | ~np.isfinite(poses))
    if len(beyond):
        pose, joint = beyond[0]
        raise ExoidError(
            f"pose {pose} asks {leg.joint_names[joint]} for {np.rad2deg(poses[pose, joint]):.1f}°",
            where=leg.description.name,
            remedy=f"stay between {np.rad2deg(lower[joint]):.1f}° and {np.rad2deg(upper[joint]):.1f}°",
        )


def refuse_motion_beyond_limits(leg: Leg, reference: Reference, duration: float, rate: float = 100.0) -> None:
    """Refuse a motion that leaves the limits of angle or speed.

    Args:
        leg: With its limits.
        reference: The motion.
        duration: How long it is followed [s].
        rate: How often it is checked [Hz].

    Raises:
        ExoidError: Names the joint, the time, what is asked and what the limit is.
    """
    time = np.arange(0.0, duration + 0.5 / rate, 1.0 / rate)
    targets = [reference.at(t) for t in time]
    q, v = (np.array([np.asarray(target[k]) for target in targets]) for k in (0, 1))
    lower, upper, fastest, _ = (limit[:, None] for limit in leg.limits)
    for what, values, wrong, unit in (
        ("an angle", q, (q < lower - TOLERANCE) | (q > upper + TOLERANCE), "°"),
        ("a speed", v, np.abs(v) > fastest + TOLERANCE, "°/s"),
    ):
        if wrong.any():
            k, joint, rig = np.argwhere(wrong)[0]
            allowed = (
                f"{np.rad2deg(lower[joint, 0]):.1f}° to {np.rad2deg(upper[joint, 0]):.1f}°"
                if unit == "°"
                else f"up to {np.rad2deg(fastest[joint, 0]):.0f}°/s"
            )
            raise ExoidError(
                f"the motion asks {leg.joint_names[joint]} for {what} of {np.rad2deg(values[k, joint, rig]):.1f}{unit} "
                f"at {time[k]:.2f} s",
                where=leg.description.name,
                remedy=f"it can do {allowed}: make the motion smaller or slower",
            )
