"""Columns of the momentum and its torques for each parameter of an estimate, for the band of an observer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.other_term import SLIDING
from exoid.estimate import Estimate
from exoid.torques import InternalState, Motion, TorqueModel
from exoid.torques.with_columns import WithColumns


class MomentumColumns(NamedTuple):
    """Derivatives of momentum and torque by the parameters, (K, n) or (N, K, n) each."""

    p: FloatArray  # columns of M(q) v
    model: FloatArray  # columns of Cᵀv − G − springs − friction


@dataclass(frozen=True, eq=False)
class ParameterBand:
    """Columns of an estimate's parameters, and of friction of other forms where the estimate has a model error."""

    # With W(q, v, a) the columns of the torque, those of the momentum are W(q, 0, v) − W(q, 0, 0). Those of
    # Cᵀv − G − … are those of Cᵀv, by the quadratic form of `.MomentumTerms`, less W(q, v, 0) without Coriolis
    # terms. Contacts with memory count as sliding, as in `exoid.control.ControlModel`.

    estimate: Estimate  # the estimate

    def columns(self, q: FloatArray, v: FloatArray) -> MomentumColumns:
        """Form the columns."""
        count, n = q.shape
        rigid = len(self.estimate.leg.parameter_names)
        still, units = np.zeros_like(q), np.eye(n)
        speeds = [still, v, *(v + unit for unit in units), *(still + unit for unit in units), still]
        accelerations = [*[still] * (2 + 2 * n), v]
        stacked = self._columns(np.tile(q, (len(speeds), 1)), np.vstack(speeds), np.vstack(accelerations))
        parts = stacked.transpose(2, 0, 1).reshape(len(speeds), count, -1, n)
        rest, moving, mixed, single, pushed = parts[0], parts[1], parts[2 : 2 + n], parts[2 + n : -1], parts[-1]
        model = -moving
        gravity, c = rest[:, :rigid], moving[:, :rigid]
        for i in range(n):
            pair = mixed[i, :, :rigid] - c - single[i, :, :rigid] + gravity
            model[:, :rigid, i] = 0.5 * np.einsum("nj,nkj->nk", v, pair) - gravity[..., i]
        return MomentumColumns(pushed - rest, model)

    def variance(self, filtered: FloatArray) -> FloatArray:
        """Variance that the errors of the parameters and the model error give a filtered balance."""
        rows = filtered.transpose(0, 2, 1)
        found = ((rows[..., : len(self._covariance)] @ self._covariance) * rows[..., : len(self._covariance)]).sum(-1)
        if self.estimate.model_error is not None:
            found = found + self.estimate.model_error.variance(rows)
        return np.asarray(np.clip(found, 0.0, None))

    @property
    def _covariance(self) -> FloatArray:
        return self.estimate.covariance

    @cached_property
    def count(self) -> int:
        """Number of columns, K."""
        return len(self._model.names)

    @cached_property
    def _model(self) -> TorqueModel | WithColumns:
        return self.estimate.band_model

    @cached_property
    def _states(self) -> list[tuple[int, InternalState]]:
        """Joint and kind of each internal state."""
        nothing = np.zeros((2, len(self.estimate.joint_names)))
        return list(self._model.motion(nothing, nothing, nothing).states)

    def _columns(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Columns of the torque, (K, n, N)."""
        states = {key: np.tanh(v[:, key[0]] / SLIDING) for key in self._states}
        return self._model.columns(Motion(q, v, a, states=states))
