"""Homogeneous transforms and rotations."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.signals.base_pose import continuous


def homogeneous(translation: ArrayLike, rotation: FloatArray | None = None) -> FloatArray:
    """Homogeneous transform of a translation [m] and a rotation, (4, 4)."""
    transform = np.eye(4)
    transform[:3, 3] = np.asarray(translation, dtype=np.float64)
    if rotation is not None:
        transform[:3, :3] = rotation
    return transform


def align_z(direction: ArrayLike, near_y: ArrayLike = (0.0, 1.0, 0.0)) -> FloatArray:
    """Rotation whose z axis points along a direction and whose y axis is as close as possible to another."""
    z = np.asarray(direction, dtype=np.float64)
    z = z / np.linalg.norm(z)
    y = np.asarray(near_y, dtype=np.float64)
    if np.linalg.norm(np.cross(y, z)) < 1e-6 * np.linalg.norm(y):
        y = np.eye(3)[np.argmin(np.abs(z))]
    x = np.cross(y, z)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def quaternions(rotation: FloatArray) -> FloatArray:
    """Quaternions (x, y, z, w) of rotation matrices (F, 3, 3), without jumps of sign, (F, 4)."""
    return continuous(scipy.spatial.transform.Rotation.from_matrix(rotation).as_quat())
