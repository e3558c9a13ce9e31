"""Checks of poses and motions against the limits of a leg, before an experiment runs."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.rig import Reference
from exoid.tools.numbers import ROUNDED, checked


def refuse_poses_beyond_limits(leg: Leg, poses: ArrayLike) -> None:
    """Refuse poses that a joint cannot reach."""
    angles = np.asarray(poses, dtype=np.float64)
    if angles.ndim != 2 or angles.shape[1] != len(leg.joint_names) or not len(angles):
        raise BadArgumentError(
            f"poses of shape {angles.shape}",
            where=leg.description.name,
            remedy=f"pass one row a pose and one column for each of {', '.join(leg.joint_names)}",
        )
    lower, upper, *_ = leg.limits
    beyond = np.argwhere(~((angles >= lower - ROUNDED) & (angles <= upper + ROUNDED)))  # NaN counts as beyond
    if len(beyond):
        pose, joint = beyond[0]
        raise BadArgumentError(
            f"pose {pose} asks {leg.joint_names[joint]} for {np.rad2deg(angles[pose, joint]):.1f}°",
            where=leg.description.name,
            remedy=f"stay between {np.rad2deg(lower[joint]):.1f}° and {np.rad2deg(upper[joint]):.1f}°",
        )


def refuse_motion_beyond_limits(leg: Leg, reference: Reference, duration: float) -> None:
    """Refuse a motion that exceeds the limits of angle or speed."""
    checked(duration, "the duration of the motion [s]", above=0.0)
    time = np.arange(0.0, duration + 0.005, 0.01)
    targets = [reference.at(float(t)) for t in time]
    q, v = np.array([target.q for target in targets]), np.array([target.v for target in targets])
    if q.ndim != 3 or q.shape[1] != len(leg.joint_names):
        raise BadArgumentError(
            f"a motion of shape {q.shape[1:]}",
            where=leg.description.name,
            remedy=f"give one row for each of {', '.join(leg.joint_names)} and one column a rig",
        )
    lower, upper, fastest, _ = (limit[:, None] for limit in leg.limits)
    _refuse(leg, time, "an angle", "°", q, lower, upper)
    _refuse(leg, time, "a speed", "°/s", v, -fastest, fastest)


def _refuse(
    leg: Leg, time: FloatArray, quantity: str, unit: str, values: FloatArray, lowest: FloatArray, highest: FloatArray
) -> None:
    beyond = np.argwhere(~((values >= lowest - ROUNDED) & (values <= highest + ROUNDED)))  # NaN counts as beyond
    if len(beyond):
        k, joint, rig = beyond[0]
        raise BadArgumentError(
            f"the motion asks {leg.joint_names[joint]} for {quantity} of {np.rad2deg(values[k, joint, rig]):.1f}{unit} "
            f"at {time[k]:.2f} s",
            where=leg.description.name,
            remedy=f"it goes from {np.rad2deg(values[:, joint].min()):.1f} to {np.rad2deg(values[:, joint].max()):.1f}"
            f"{unit}, the joint from {np.rad2deg(lowest[joint, 0]):.1f} to {np.rad2deg(highest[joint, 0]):.1f}{unit}: "
            "make the motion smaller or slower",
        )
