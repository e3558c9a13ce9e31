"""Rows of one joint for the sequential procedures: columns by name, and the torque they explain."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import TorqueModel


class JointRows(NamedTuple):
    """Both sides of one joint's equation.

    Attributes:
        columns: Regressor column of every parameter, (M,) each.
        tau: Measured torque [N·m], (M,).
        q: Angles of all joints [rad], (M, n).
        v: Velocities of all joints [rad/s], (M, n).
    """

    columns: Mapping[str, FloatArray]
    tau: FloatArray
    q: FloatArray
    v: FloatArray

    def where(self, mask: NDArray[np.bool_]) -> JointRows:
        """Keep only some rows."""
        columns = {name: column[mask] for name, column in self.columns.items()}
        return JointRows(columns, self.tau[mask], self.q[mask], self.v[mask])


def static_rows(model: TorqueModel, poses: Poses, joint: int) -> JointRows:
    """Rows of a joint at rest: no velocity, no acceleration."""
    still = np.zeros_like(poses.q)
    W = model.regressor(poses.q, still, still, poses.torso)[:, joint]
    return JointRows(dict(zip(model.names, W.T, strict=True)), poses.tau[:, joint], poses.q, still)


def dynamic_rows(
    model: TorqueModel, recordings: Iterable[Recording], joint: int, preparation: Preparation
) -> JointRows:
    """Rows of a joint in motion, of several recordings after each other."""
    W, tau, q, v = [], [], [], []
    for recording in recordings:
        even = recording.resampled()
        moved = preparation.kinematics(even)
        rate, rows = even.sample_rate, moved.valid
        columns = model.regressor(moved.q, moved.v, moved.a, even.torso)[:, joint]
        W.append(preparation.filter_columns(columns, rate)[rows])
        tau.append(preparation.filter(np.asarray(even.tau), rate)[rows, joint])
        q.append(moved.q[rows])
        v.append(moved.v[rows])
    stacked = np.concatenate(W)
    return JointRows(
        dict(zip(model.names, stacked.T, strict=True)), np.concatenate(tau), np.concatenate(q), np.concatenate(v)
    )
