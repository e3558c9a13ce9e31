"""Rows of one joint for the sequential procedures: regressor columns by name, and measured torque."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.leg import Leg
from exoid.regression.every_row import make_rows
from exoid.signals import FiniteDifference, Poses, Preparation, Recording
from exoid.torques import Term, TorqueModel


class JointRows(NamedTuple):
    """Rows of the torque equation of one joint."""

    columns: Mapping[str, FloatArray]  # regressor column of every parameter, (M,) each
    tau: FloatArray  # measured torque [N·m], (M,)
    v: FloatArray  # velocity of the joint [rad/s], (M,)
    independent_fraction: float = 1.0  # share of the rows that carries independent noise; a filter leaves fewer

    def where(self, mask: NDArray[np.bool_]) -> JointRows:
        """Select the rows of a mask, (M,)."""
        columns = {name: column[mask] for name, column in self.columns.items()}
        return JointRows(columns, self.tau[mask], self.v[mask], self.independent_fraction)

    def neglecting(self, prefix: str) -> JointRows:
        """Set the parameters whose names have this prefix to zero."""
        columns = {name: column for name, column in self.columns.items() if not name.startswith(prefix)}
        return self._replace(columns=columns)

    def mean_of_pairs(self) -> JointRows:
        """Average rows in consecutive pairs."""
        columns = {name: 0.5 * (column[0::2] + column[1::2]) for name, column in self.columns.items()}
        return self._replace(columns=columns, tau=0.5 * (self.tau[0::2] + self.tau[1::2]), v=self.v[0::2])

    def explained(self, values: Mapping[str, float], without: Sequence[str] = ()) -> FloatArray:
        """Compute the torque of some parameters [N·m], (M,), except those of ``without``."""
        named = [name for name in values if name in self.columns and name not in without]
        return np.asarray(sum((values[name] * self.columns[name] for name in named), np.zeros_like(self.tau)))


def rows_at_rest(model: TorqueModel, poses: Poses, joint: int) -> JointRows:
    """Make the rows of a joint in static poses."""
    rows = make_rows(model, poses, FiniteDifference())
    return _of_joint(model, rows.W[:, joint], rows.tau[:, joint], np.zeros(len(rows.tau)), 1.0)


def rows_in_motion(
    model: TorqueModel, recordings: Sequence[Recording], joint: int, preparation: Preparation
) -> JointRows:
    """Make the rows of a joint in several recordings, in sequence."""
    if not recordings:
        raise BadArgumentError("no recordings", remedy="pass at least one")
    each = [make_rows(model, recording, preparation) for recording in recordings]
    return _of_joint(
        model,
        np.concatenate([rows.W[:, joint] for rows in each]),
        np.concatenate([rows.tau[:, joint] for rows in each]),
        np.concatenate([rows.v[:, joint] for rows in each]),
        min(rows.independent_fraction for rows in each),
    )


def planar_model(leg: Leg, joints: Sequence[str], document: int, terms: Sequence[Term]) -> TorqueModel:
    """Make the torque model of a document's procedure."""
    if leg.chain is None or leg.chain.n != len(joints):
        raise NotSupportedError(
            f"document {document}'s procedure needs a planar leg of {', '.join(joints[:-1])} and {joints[-1]}",
            where=leg.description.name,
            remedy="use exoid.identify, which works for any leg",
        )
    return TorqueModel(leg, tuple(terms))


def _of_joint(
    model: TorqueModel, W: FloatArray, tau: FloatArray, v: FloatArray, independent_fraction: float
) -> JointRows:
    return JointRows(dict(zip(model.names, W.T, strict=True)), tau, v, independent_fraction)
