"""Pinocchio's algorithms sample by sample, arrays in and arrays out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ._typing import FloatArray
from .model import configuration


class SegmentPlacements(NamedTuple):
    """Where the frame of each segment, at its joint, is in the base frame.

    Attributes:
        rotation: Orientations, (N, n, 3, 3).
        translation: Origins [m], (N, n, 3).
    """

    rotation: FloatArray
    translation: FloatArray


def inverse_dynamics(model: pin.Model, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Joint torques by the recursive Newton-Euler algorithm [N·m], (N, n)."""
    data = model.createData()
    rows = zip(configuration(model, q), v, a, strict=True)
    return np.array([pin.rnea(model, data, *row) for row in rows]).reshape(v.shape)


def joint_torque_regressor(model: pin.Model, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Pinocchio's regressor Y with Y π = RNEA, (N, n, 10 n)."""
    data = model.createData()
    out = np.empty((*v.shape, 10 * (model.njoints - 1)))
    for i, row in enumerate(zip(configuration(model, q), v, a, strict=True)):
        out[i] = pin.computeJointTorqueRegressor(model, data, *row)
    return out


def mass_matrix(model: pin.Model, q: FloatArray) -> FloatArray:
    """M(q) by the composite rigid-body algorithm, (N, n, n)."""
    data = model.createData()
    upper = np.array([np.triu(pin.crba(model, data, row)) for row in configuration(model, q)])
    upper = upper.reshape(len(q), model.nv, model.nv)
    return np.asarray(upper + np.swapaxes(np.triu(upper, 1), 1, 2))


def coriolis_matrix(model: pin.Model, q: FloatArray, v: FloatArray) -> FloatArray:
    """C(q, v) with C v the Coriolis and centrifugal torque and ½Ṁ − C skew, (N, n, n)."""
    data = model.createData()
    rows = zip(configuration(model, q), v, strict=True)
    matrices = [pin.computeCoriolisMatrix(model, data, *row).copy() for row in rows]
    return np.array(matrices).reshape(len(q), model.nv, model.nv)


def gravity_torque(model: pin.Model, q: FloatArray) -> FloatArray:
    """G(q) [N·m], (N, n)."""
    data = model.createData()
    torques = [pin.computeGeneralizedGravity(model, data, row).copy() for row in configuration(model, q)]
    return np.array(torques).reshape(len(q), model.nv)


def segment_placements(model: pin.Model, q: FloatArray) -> SegmentPlacements:
    """Forward kinematics: frames of all joints after the universe."""
    data = model.createData()
    n = model.njoints - 1
    placements = SegmentPlacements(np.empty((len(q), n, 3, 3)), np.empty((len(q), n, 3)))
    for i, row in enumerate(configuration(model, q)):
        pin.forwardKinematics(model, data, row)
        for j in range(n):
            placements.rotation[i, j] = data.oMi[j + 1].rotation
            placements.translation[i, j] = data.oMi[j + 1].translation
    return placements
