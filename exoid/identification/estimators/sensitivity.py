"""How the torque of a model answers to small changes of the motion, at all samples at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torques import Motion, TorqueModel

STEPS = (1e-5, 1e-5, 1e-3)
"""Half of the central difference in angle, velocity and acceleration; the torque is linear in the last."""


class Response(NamedTuple):
    """Torque and its derivatives."""

    W: FloatArray  # regressor, (N, n, P)
    to_motion: FloatArray  # ∂τ_i / ∂(q, v, a)_j, (3, N, n, n): derivative, sample, torque, joint


def respond(model: TorqueModel, values: FloatArray, motion: Motion) -> Response:
    """Differentiate τ = W(q, v, a) β by central differences."""
    samples, joints = motion.q.shape
    to_motion = np.empty((3, samples, joints, joints))
    for kind, step in enumerate(STEPS):
        for joint in range(joints):
            there, back = (_moved(motion, kind, joint, sign * step) for sign in (1.0, -1.0))
            difference = torque(model.columns(there), values) - torque(model.columns(back), values)
            to_motion[kind, :, :, joint] = difference / (2.0 * step)
    return Response(model.columns(motion).transpose(2, 1, 0), to_motion)


def torque(columns: FloatArray, values: FloatArray) -> FloatArray:
    """W β, (N, n), from columns, (P, n, N)."""
    return np.asarray(np.tensordot(values, columns, axes=1).T)


def _moved(motion: Motion, kind: int, joint: int, by: float) -> Motion:
    arrays = [motion.q, motion.v, motion.a]
    arrays[kind] = arrays[kind].copy()
    arrays[kind][:, joint] += by
    q, v, a = arrays
    return Motion(q, v, a, motion.torso)
