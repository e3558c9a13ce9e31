"""Floating base: its model, its rows, and the coordinates that they belong to."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

from .reduction import Plane

FREE_ROWS = ("base_fx", "base_fy", "base_fz", "base_mx", "base_my", "base_mz")
"""Rows of a base that floats in space: force [N] and moment about the origin of the root link [N·m], in its axes."""


def free_flyer_model(model: pin.Model) -> pin.Model:
    """Put a joint of six degrees of freedom before the root link."""
    base = pin.Model()
    joint = base.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "exoid base")
    frame = base.addFrame(pin.Frame("exoid base", joint, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    free = pin.appendModel(base, model, frame, pin.SE3.Identity())
    for body, inertia in enumerate(model.inertias, start=1):  # Pinocchio adds them, which negative masses do not bear
        free.inertias[body] = inertia
    free.gravity = model.gravity
    return free


def planar_coordinates(plane: Plane, hip: FloatArray) -> FloatArray:
    """Twist of the root link per unit of the coordinates of a planar base: hip forward, hip up, pitch about the hip."""
    # Its transpose takes force and moment about the origin to the rows of a planar base.
    pitch = -plane.lateral
    columns = [np.r_[plane.forward, 0, 0, 0], np.r_[plane.up, 0, 0, 0], np.r_[-np.cross(pitch, hip), pitch]]
    return np.column_stack(columns)


def project_columns(matrix: FloatArray, coordinates: FloatArray) -> FloatArray:
    """Write columns of the six freedoms of a base in its coordinates."""
    return np.concatenate([matrix[..., :6] @ coordinates, matrix[..., 6:]], axis=-1)
