"""Pinocchio's algorithms for arrays of samples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

from .model import configuration, joint_axis


class SegmentPlacements(NamedTuple):
    """Placement of each segment frame, at its joint, in the base frame."""

    rotation: FloatArray  # rotation matrices, (N, n, 3, 3)
    translation: FloatArray  # origins [m], (N, n, 3)

    def __repr__(self) -> str:
        """Write the size in one line."""
        samples, segments = self.translation.shape[:2]
        return f"SegmentPlacements({samples} samples, {segments} segments)"


def inverse_dynamics(model: pin.Model, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Compute joint torques by the recursive Newton-Euler algorithm."""
    data = model.createData()
    rows = zip(configuration(model, q), v, a, strict=True)
    return np.array([pin.rnea(model, data, *row) for row in rows]).reshape(v.shape)


def inverse_dynamics_on_base(
    free: pin.Model, q: FloatArray, v: FloatArray, a: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> FloatArray:
    """Compute force and moment on the base, and joint torques, behind a free-flyer joint."""
    weightless = pin.Model(free)
    weightless.gravity.setZero()
    data = weightless.createData()
    at_origin = np.hstack([np.zeros((len(q), 6)), q])
    states = np.hstack([velocity, v]), np.hstack([acceleration, a])
    rows = zip(configuration(free, at_origin), *states, strict=True)
    return np.array([pin.rnea(weightless, data, *row) for row in rows]).reshape(len(q), free.nv)


def inverse_dynamics_slopes(model: pin.Model, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Compute the derivatives of joint torques by angles, velocities and accelerations, (3, N, n, n)."""
    data, slopes = model.createData(), np.empty((len(v), 3, model.nv, model.nv))
    for out, *row in zip(slopes, configuration(model, q), v, a, strict=True):
        out[:] = pin.computeRNEADerivatives(model, data, *row)
    upper = np.triu(slopes[:, 2])  # Pinocchio fills the upper half
    slopes[:, 2] = upper + np.triu(upper, 1).transpose(0, 2, 1)
    return np.asarray(slopes.swapaxes(0, 1))


def mass_matrix(model: pin.Model, q: FloatArray) -> FloatArray:
    """Compute the mass matrix M(q) by the composite rigid-body algorithm."""
    data = model.createData()
    upper = np.array([np.triu(pin.crba(model, data, row)) for row in configuration(model, q)])
    upper = upper.reshape(len(q), model.nv, model.nv)
    return np.asarray(upper + np.swapaxes(np.triu(upper, 1), 1, 2))


def gravity_slopes(model: pin.Model, q: FloatArray) -> FloatArray:
    """Compute the derivatives of the gravity torque −m (∂c/∂q)ᵀ g, with c the centre of mass, by g, (3, N, n)."""
    data, slopes = model.createData(), np.empty((len(q), 3, model.nv))
    for out, row in zip(slopes, configuration(model, q), strict=True):
        out[:] = pin.jacobianCenterOfMass(model, data, row, False).reshape(3, -1)  # one joint has (3,)
    return np.asarray(-pin.computeTotalMass(model) * slopes.swapaxes(0, 1))


class JointFrames(NamedTuple):
    """Placement of each joint frame in the base frame, samples last."""

    rotation: FloatArray  # rotation matrices, (n, 3, 3, N)
    translation: FloatArray  # origins [m], (n, 3, N)


def joint_frames(model: pin.Model, q: FloatArray) -> JointFrames:
    """Compute the frames of all joints for angles (n, N)."""
    # With R and p of the parent, the constant placement (R₀, p₀) of joint j and its axis u, by Rodrigues' formula,
    #
    #     R_j = R R₀ [cos q (1 − u uᵀ) + sin q [u]× + u uᵀ],  p_j = p + R p₀        (revolute)
    #     R_j = R R₀,                                         p_j = p + R (p₀ + R₀ u q)    (prismatic)
    #
    # (Featherstone 2008, ch. 4). The interpreter works once for each joint, and not for each sample.
    n = model.njoints - 1
    # samples last: wide products
    rotation, translation = np.empty((n, 3, 3, q.shape[1])), np.empty((n, 3, q.shape[1]))
    root = np.broadcast_to(np.eye(3)[..., None], (3, 3, q.shape[1])), np.zeros((3, q.shape[1]))
    for j in range(n):
        joint, at, parent = model.joints[j + 1], model.jointPlacements[j + 1], model.parents[j + 1] - 1
        R, p = root if parent < 0 else (rotation[parent], translation[parent])
        axis = joint_axis(joint)
        slide, u = axis[:3], axis[3:]
        along = np.outer(u, u)
        np.matmul(at.rotation.T, R, out=rotation[j])
        np.add(p, at.translation @ R, out=translation[j])
        if slide.any():
            translation[j] += (slide @ rotation[j]) * q[joint.idx_v]
        elif np.abs(u).max() == 1.0:  # about an axis of its frame, which is usual: only the two others turn
            k, angle = int(np.abs(u).argmax()), q[joint.idx_v]
            c, s, (a, b) = np.cos(angle), u[k] * np.sin(angle), rotation[j].swapaxes(0, 1)[[k - 2, k - 1]]
            rotation[j, :, k - 2], rotation[j, :, k - 1] = c * a + s * b, c * b - s * a
        elif u.any():
            across, turned = (np.eye(3) - along) @ rotation[j], pin.skew(u).T @ rotation[j]
            rotation[j] = along @ rotation[j] + np.cos(q[joint.idx_v]) * across + np.sin(q[joint.idx_v]) * turned
    return JointFrames(rotation, translation)
