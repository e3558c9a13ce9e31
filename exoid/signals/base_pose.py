"""Pose of the base in the laboratory during a recording, and the motion that follows from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError

from . import checks
from .timebase import Sampled

POSE_COLUMNS = ("base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw")
"""Columns of a pose: position [m] and quaternion of the root link in the laboratory, whose z axis points up."""


@dataclass(frozen=True, eq=False, repr=False)
class BasePose(Sampled):
    """Position and orientation of the root link in the laboratory, at the samples of a recording.

    The z axis of the laboratory points up. Quaternions are normalised when the pose is made, and their signs are
    chosen such that they do not jump: q and −q are one orientation.

    Attributes:
        position: Position of the root link's origin [m], (N, 3).
        quaternion: Orientation (x, y, z, w), laboratory from root link, (N, 4).

    Raises:
        ExoidError: Shapes do not fit, a number is missing, or a quaternion is not of norm 1.

    Example:
        >>> BasePose(np.zeros((10, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (10, 1))).rotation[0]
        array([[1., 0., 0.],
               [0., 1., 0.],
               [0., 0., 1.]])
    """

    position: FloatArray
    quaternion: FloatArray

    def __post_init__(self) -> None:
        for name in ("position", "quaternion"):
            object.__setattr__(self, name, checks.as_numbers(getattr(self, name), f"{name} of the base"))
        samples = len(np.atleast_1d(self.position))
        checks.refuse_shape(self.position, (samples, 3), "position of the base")
        checks.refuse_shape(self.quaternion, (samples, 4), "quaternion")
        checks.refuse_not_finite(self.columns, POSE_COLUMNS)
        checks.refuse_implausible("", self.columns, POSE_COLUMNS)
        object.__setattr__(self, "quaternion", checks.as_numbers(continuous(self.quaternion), "quaternion"))

    @cached_property
    def rotation(self) -> FloatArray:
        """Rotation matrices, laboratory from root link, (N, 3, 3)."""
        return np.asarray(scipy.spatial.transform.Rotation.from_quat(self.quaternion.copy()).as_matrix())

    @property
    def columns(self) -> FloatArray:
        """Columns in the order of :data:`POSE_COLUMNS`, (N, 7)."""
        return np.hstack([self.position, self.quaternion])

    def rows(self, rows: slice | BoolArray) -> BasePose:
        """Select samples."""
        return BasePose(self.position[rows], self.quaternion[rows])

    def _changed(self, change: Callable[[FloatArray, bool], FloatArray]) -> BasePose:
        columns = change(self.columns, True)
        return BasePose(columns[:, :3], columns[:, 3:] / np.linalg.norm(columns[:, 3:], axis=1, keepdims=True))

    def __len__(self) -> int:
        return len(self.position)

    def __repr__(self) -> str:
        return f"BasePose({len(self)} samples)"


def continuous(quaternion: FloatArray) -> FloatArray:
    """Normalise quaternions, and choose signs such that they do not jump."""
    if not len(quaternion):
        return quaternion
    norm = np.linalg.norm(quaternion, axis=1)
    worst = int(np.argmax(np.abs(norm - 1.0)))
    if abs(norm[worst] - 1.0) > 1e-2:  # less is rounding
        raise BadArgumentError(
            f"the quaternion of the base in row {worst} has norm {norm[worst]:.4g}",
            remedy="pass unit quaternions (x, y, z, w)",
        )
    # Exact ones stay as they are, so that files read back exactly
    unit = np.where(np.abs(norm - 1.0)[:, np.newaxis] < 1e-14, quaternion, quaternion / norm[:, np.newaxis])
    flips = np.sum(unit[1:] * unit[:-1], axis=1) < 0.0
    signs = np.concatenate([[1.0], np.cumprod(np.where(flips, -1.0, 1.0))])
    return np.asarray(unit * signs[:, np.newaxis])


def refuse_jumps(time: FloatArray, position: FloatArray, quaternion: FloatArray) -> None:
    """Refuse poses that move faster than a base can."""
    interval = np.diff(time)
    overlap = np.clip(np.sum(quaternion[1:] * quaternion[:-1], axis=1), -1.0, 1.0)
    turning = 2.0 * np.arccos(overlap) / interval
    moving = np.linalg.norm(np.diff(position, axis=0), axis=1) / interval
    for speeds, limit, unit, what in ((turning, 35.0, "rad/s", "orientation"), (moving, 20.0, "m/s", "position")):
        if speeds.max() > limit:
            raise BadArgumentError(
                f"the {what} of the base jumps before row {int(np.argmax(speeds)) + 1}: {speeds.max():.3g} {unit}",
                remedy="remove swapped or lost markers" + (", and give positions in m" if unit == "m/s" else ""),
            )


def turn_upright(up: ArrayLike) -> FloatArray:
    """Compute the shortest rotation that turns the vertical of a laboratory to z.

    Args:
        up: Direction against gravity in the laboratory, (3,): (0, 1, 0) where y points up.

    Returns:
        Rotation matrix, (3, 3): ``vectors @ matrix.T`` are vectors in axes whose z points up.

    Raises:
        ExoidError: It has no direction.

    Example:
        >>> turn_upright((0.0, 1.0, 0.0)) @ (0.1, 1.0, 0.2)
        array([ 0.1, -0.2,  1. ])
    """
    turn, _ = scipy.spatial.transform.Rotation.align_vectors([[0.0, 0.0, 1.0]], [checks.as_direction(up)])
    return np.asarray(turn.as_matrix())


def twice_imaginary(h: FloatArray, other: FloatArray) -> FloatArray:
    """2 Im(h* g) of quaternions (x, y, z, w), (N, 3): with g = ḣ the angular velocity in the axes of the body."""
    vector, scalar = h[:, :3], h[:, 3:]
    return np.asarray(2.0 * (scalar * other[:, :3] - other[:, 3:] * vector - np.cross(vector, other[:, :3])))
