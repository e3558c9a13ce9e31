"""Model error of an estimate: what friction of another form may add to a torque, above all beyond the training."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.torques import TorqueModel
from exoid.torques.with_columns import WithColumns

from .alternative_friction import COUNT, with_alternatives


@dataclass(frozen=True, eq=False)
class ModelError:
    """Second moment of the torque that friction of other forms would add, after the parameters have absorbed theirs.

    A joint's torque may contain z c, with z the columns of :class:`.AlternativeFriction` and c unknown coefficients.
    The fit of the parameters alone absorbs w G c of it, with G the regression of z on the training's rows. The
    prediction then errs by (z − w G) c, which is as small as the residuals inside the training and grows beyond it.
    With E[c cᵀ] = L Lᵀ its second moment is ‖(z − w G) L‖² = ‖w A + z B‖².

    Attributes:
        speed: Largest speed of the training [rad/s], (n,).
        parameters: A, (P, r).
        alternatives: B of each joint, (n, K, r).
        explained: Mean second moment on the rows of the training [N²·m²], (n,): part of the residual variance.
    """

    speed: FloatArray
    parameters: FloatArray
    alternatives: FloatArray
    explained: FloatArray

    def __post_init__(self) -> None:
        """Check shapes and forbid changes."""
        joints, rank = len(self.speed), self.parameters.shape[1]
        fits = self.alternatives.shape == (joints, COUNT, rank) and self.explained.shape == (joints,)
        for array in (self.speed, self.parameters, self.alternatives, self.explained):
            if not (fits and np.isfinite(array).all()):
                raise BadArgumentError("the model error does not fit the estimate's joints", remedy="identify again")
            array.flags.writeable = False

    def model(self, model: TorqueModel, values: FloatArray) -> WithColumns:
        """Add the columns of the alternatives to a torque model.

        Args:
            model: Torque model of the estimate.
            values: Its parameters, (P,).

        Returns:
            Model with P + K columns.
        """
        return with_alternatives(model, values, self.speed)

    def variance(self, rows: FloatArray) -> FloatArray:
        """Second moment of the error of predicted torques.

        Args:
            rows: Rows of parameters and alternatives, filtered or not, (N, n, P + K).

        Returns:
            Second moments [N²·m²], (N, n).
        """
        count = len(self.parameters)
        moved = rows[..., :count] @ self.parameters + np.einsum("njk,jkr->njr", rows[..., count:], self.alternatives)
        return np.asarray((moved**2).sum(axis=-1))

    def noise(self, residual: FloatArray) -> FloatArray:
        """Part of a residual variance that is noise.

        Args:
            residual: Residual variance of the training [N²·m²], (n,).

        Returns:
            The variance less what alternatives explain of it, (n,).
        """
        # At least this part of the residual variance is noise, whatever the alternatives explain
        return np.maximum(residual - self.explained, 0.25 * residual)
