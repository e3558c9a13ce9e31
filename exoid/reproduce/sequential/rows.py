"""Rows of one joint for the sequential procedures: columns by name, and the torque they explain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.regression.rows import for_leg, make_rows
from exoid.signals import FiniteDifference, Poses, Preparation, Recording
from exoid.torques import TorqueModel


class JointRows(NamedTuple):
    """Both sides of one joint's equation.

    Attributes:
        columns: Regressor column of every parameter, (M,) each.
        tau: Measured torque [N·m], (M,).
        v: Velocity of the joint [rad/s], (M,).
        independent_fraction: Share of the rows that carries independent noise; a filter leaves fewer.
    """

    columns: Mapping[str, FloatArray]
    tau: FloatArray
    v: FloatArray
    independent_fraction: float = 1.0

    def where(self, mask: NDArray[np.bool_]) -> JointRows:
        """Keep only some rows."""
        columns = {name: column[mask] for name, column in self.columns.items()}
        return JointRows(columns, self.tau[mask], self.v[mask], self.independent_fraction)

    def neglecting(self, prefix: str) -> JointRows:
        """Take the parameters whose names begin like this as zero."""
        columns = {name: column for name, column in self.columns.items() if not name.startswith(prefix)}
        return self._replace(columns=columns)

    def mean_of_pairs(self) -> JointRows:
        """Average the first row with the second, the third with the fourth, and so on."""
        columns = {name: 0.5 * (column[0::2] + column[1::2]) for name, column in self.columns.items()}
        return self._replace(columns=columns, tau=0.5 * (self.tau[0::2] + self.tau[1::2]), v=self.v[0::2])

    def explained(self, values: Mapping[str, float], without: Sequence[str] = ()) -> FloatArray:
        """Torque that parameters explain, some of them left out [N·m], (M,)."""
        named = [name for name in values if name in self.columns and name not in without]
        return np.asarray(sum((values[name] * self.columns[name] for name in named), np.zeros_like(self.tau)))


def rows_at_rest(model: TorqueModel, poses: Poses, joint: int) -> JointRows:
    """Rows of a joint in poses.

    Raises:
        ExoidError: A joint of the leg is missing.
    """
    rows = make_rows(model, poses, FiniteDifference())
    return _of_joint(model, rows.W[:, joint], rows.tau[:, joint], np.zeros(len(rows.tau)), 1.0)


def rows_in_motion(
    model: TorqueModel, recordings: Sequence[Recording], joint: int, preparation: Preparation
) -> JointRows:
    """Rows of a joint in several recordings, one after the other.

    Raises:
        ExoidError: There is no recording, or one has no torque, lacks a joint or is too short.
    """
    if not recordings:
        raise ExoidError("no recordings", remedy="pass at least one")
    each = [make_rows(model, recording, preparation) for recording in recordings]
    motions = [preparation.kinematics(for_leg(model, recording).resampled()) for recording in recordings]
    return _of_joint(
        model,
        np.concatenate([rows.W[:, joint] for rows in each]),
        np.concatenate([rows.tau[:, joint] for rows in each]),
        np.concatenate([motion.v[motion.valid, joint] for motion in motions]),
        min(rows.independent_fraction for rows in each),
    )


def _of_joint(
    model: TorqueModel, W: FloatArray, tau: FloatArray, v: FloatArray, independent_fraction: float
) -> JointRows:
    return JointRows(dict(zip(model.names, W.T, strict=True)), tau, v, independent_fraction)
