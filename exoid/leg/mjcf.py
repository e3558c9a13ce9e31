"""MuJoCo, an extra: its bodies with the inertias and axes of a leg."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.tools.extras import install_extra

from .model import joint_axis


def require_mujoco() -> Any:  # noqa: ANN401 - a module
    """Import MuJoCo, an extra of exoid."""
    try:
        import mujoco  # noqa: PLC0415 - an extra
    except ImportError:
        raise NotSupportedError("MuJoCo is not installed", remedy=install_extra("ground")) from None
    return mujoco


def joint_axes(model: pin.Model) -> FloatArray:
    """Find the axis of each joint in the frame of its body."""
    return np.array([joint_axis(model.joints[j]) for j in range(1, model.njoints)])


def set_inertia(body: Any, inertia: pin.Inertia) -> None:  # noqa: ANN401
    """Give a body of MuJoCo its inertia."""
    body.explicitinertial, body.mass, body.ipos = True, inertia.mass, inertia.lever
    matrix = inertia.inertia
    body.fullinertia = [matrix[0, 0], matrix[1, 1], matrix[2, 2], matrix[0, 1], matrix[0, 2], matrix[1, 2]]
