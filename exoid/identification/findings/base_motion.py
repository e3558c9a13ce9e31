"""Checks of the motion of the base: out of the plane of the leg, and the size of gravity in its accelerometer."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding, Severity
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.signals import Recording
from exoid.signals.moving_base import base_during, vertical

from .sample import FittedLeg


def out_of_plane_torque(
    leg: Leg, q: FloatArray, v: FloatArray, a: FloatArray, base: BaseKinematics
) -> tuple[FloatArray, FloatArray]:
    """Compute the torque that rotation of the plane of a leg adds, by Pinocchio with the inertias of the URDF."""
    # Rotation about the forward and upward axes adds torques such as (Ixx − Izz) ωx ωz and my x ω̇x, whose inertias are
    # in none of X, Y and J. Acceleration sideways adds none.
    whole = leg.inverse_dynamics(q, v, a, base)
    return whole - leg.inverse_dynamics(q, v, a, base.within_plane(leg.plane, leg.hip)), whole


def out_of_plane_base(fitted: FittedLeg) -> Iterator[Finding]:
    """Compare the torque of motion out of the plane of a leg with that of the whole motion, joint by joint."""
    model, preparation, data = fitted.model, fitted.preparation, fitted.data
    worst, name = np.zeros(len(model.leg.joint_names)), ""
    for one in data if model.leg.limbs else ():
        if not isinstance(one, Recording) or one.base is None:
            continue
        recording = model.select(one)
        base = base_during(recording, preparation)
        assert isinstance(base, BaseKinematics)
        q, v, a, valid = preparation.kinematics(recording)
        rows = np.arange(len(q))[valid]
        rows = rows[:: 1 + len(rows) // 1000]
        extra, whole = out_of_plane_torque(model.leg, q[rows], v[rows], a[rows], base.rows(rows))
        power = np.maximum(np.mean(whole**2, axis=0), np.finfo(float).tiny)
        shares = np.sqrt(np.mean(extra**2, axis=0) / power)
        if shares.max() > worst.max():
            worst, name = shares, one.file_name
    for j, joint in enumerate(model.leg.joint_names):
        share = float(worst[j])
        if share > 0.01:
            message = f"the base turns out of the leg's plane: X, Y, J do not describe {share:.2%} of {joint}'s torque"
            remedy = 'use Leg.from_urdf(..., base="moving"), which describes it, or record straighter walking'
            severity: Severity = "error" if share > 0.1 else "warning"
            doubtful, where = tuple(np.array(model.names)[model.acting[j]].tolist()), name if len(data) > 1 else ""
            yield Finding("out-of-plane-base", joint, share, "1", severity, message, remedy, None, doubtful, where)


def gravity_size(fitted: FittedLeg) -> Iterator[Finding]:
    """Compare the mean vertical specific force of each base with gravity."""
    # A base that does not fly away has no mean acceleration: the mean of f · u over a recording is g, with u
    # the vertical in its axes. A bias along it scales all gravity torques, which no residual shows.
    gravity = float(np.linalg.norm(fitted.model.leg.model.gravity.linear))
    for one in fitted.data:
        if not isinstance(one, Recording) or one.base is None or one.base.pose is not None or one.contacts:
            continue
        even = one.resampled()
        assert even.base is not None
        size = float(np.mean(np.sum(even.base.specific_force * vertical(even), axis=1)))
        error = size - gravity
        if abs(error) <= 0.05 + 1.0 / one.duration:  # 0.05 m/s² move mass moments by 0.5 %; a base may gain 1 m/s
            continue
        moved = f"which changes mass moments by {100.0 * error / gravity:.2g} %"
        message = f"the accelerometer of the base reads {size:.4g} m/s² upwards in the mean, not {gravity:g}, {moved}"
        remedy = "calibrate it (rest it on each side), or find its bias with a foot flat on the ground (contacts=)"
        doubtful, where = fitted.model.leg.parameter_names, one.file_name
        yield Finding("gravity-size", "", error, "m/s²", "warning", message, remedy, None, doubtful, where)
