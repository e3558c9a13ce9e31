"""Motion of the base out of the plane of the leg, which X, Y and J do not describe."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.regression.rows import for_leg
from exoid.signals import Poses, Preparation, Recording
from exoid.signals.moving_base import base_during
from exoid.torques import TorqueModel

NOTICEABLE = 0.01
"""Share of a joint's torque from which the motion out of the plane is a warning."""

WRONG = 0.1
"""Share of a joint's torque from which it is an error."""

MOST = 1000
"""Samples that are looked at."""


def out_of_plane_torque(
    leg: Leg, q: FloatArray, v: FloatArray, a: FloatArray, base: BaseKinematics
) -> tuple[FloatArray, FloatArray]:
    """Compute the torque that rotation of the plane of a leg adds, by Pinocchio with the inertias of the URDF."""
    # Rotation about the forward and upward axes adds torques such as (Ixx − Izz) ωx ωz and my x ω̇x, whose inertias are
    # in none of X, Y and J. Acceleration sideways adds none.
    if not leg.limbs:
        raise ExoidError("the leg has no plane", where=leg.description.name, remedy="pass a planar leg")
    whole = leg.inverse_dynamics(q, v, a, base)
    return whole - leg.inverse_dynamics(q, v, a, base.within_plane(leg.plane, leg.hip)), whole


def out_of_plane_findings(
    model: TorqueModel, preparation: Preparation, data: Sequence[Recording | Poses]
) -> Iterator[Finding]:
    """Compare the torque of motion out of the plane with that of the whole motion, joint by joint."""
    worst, name = np.zeros(len(model.joint_names)), ""
    for one in data:
        if not model.leg.limbs or isinstance(one, Poses) or one.base is None:
            continue
        shares = _shares(model, preparation, for_leg(model, one))
        if shares.max() > worst.max():
            worst, name = shares, one.source.name if one.source else ""
    for joint, share in zip(model.joint_names, worst.tolist(), strict=True):
        if share > NOTICEABLE:
            acts = model.acting[model.joint_names.index(joint)]
            yield Finding(
                "out-of-plane-base",
                joint,
                share,
                "1",
                "error" if share > WRONG else "warning",
                f"the base rotates out of the plane of the leg, which adds {100.0 * share:.2g} % to the torque of "
                f"{joint} that X, Y and J do not describe",
                'use Leg.from_urdf(..., base="moving"), which describes it, or record straighter walking',
                parameters=tuple(np.array(model.names)[acts].tolist()),
                recording=name if len(data) > 1 else "",
            )


def _shares(model: TorqueModel, preparation: Preparation, recording: Recording) -> FloatArray:
    """RMS torque of motion out of the plane over that of all motion, (n,)."""
    base = base_during(recording, preparation)
    assert isinstance(base, BaseKinematics)
    q, v, a, valid = preparation.kinematics(recording)
    rows = np.arange(len(q))[valid]
    rows = rows[:: 1 + len(rows) // MOST]
    extra, whole = out_of_plane_torque(model.leg, q[rows], v[rows], a[rows], base.rows(rows))
    tiny = np.finfo(float).tiny
    return np.asarray(np.sqrt(np.mean(extra**2, axis=0) / np.maximum(np.mean(whole**2, axis=0), tiny)))
