"""Scales for the standard deviations of the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.regression.diagnostics import SIZE, parameter_scale
from exoid.regression.least_squares import factorize
from exoid.torques import TorqueModel

from .limits import MotionLimits

STATES = 4000
"""Number of reference states."""

SPEED, ACCELERATION = 1.0, 2.0 * np.pi
"""Largest velocity [rad/s] and acceleration [rad/s²] of the reference states: those of a swing of ±9° at 1 Hz."""


class Scales(NamedTuple):
    """Expected parameters and their scales, which do not depend on the motion.

    A relative standard deviation is std / scale with scale = max(|expected value|, parameter_scale / 10). The parameter
    scale is the value that alone would explain all torque of a joint, as in :attr:`exoid.Estimate.identifiability`.
    Here it is computed over fixed reference states at all angles, so that all motions are compared on the same scale.
    Because of the second term a precise parameter near zero (Y, an offset, unknown friction) counts as well determined.

    Attributes:
        expected: Expected parameters, (P,).
        parameter_scale: Value of each parameter that alone would explain all torque of a joint, (P,).
        typical_torque: Root mean square of the torque over the reference states [N·m], (n,).
    """

    expected: FloatArray
    parameter_scale: FloatArray
    typical_torque: FloatArray

    def __repr__(self) -> str:
        """Count the parameters; write the typical torques."""
        torques = ", ".join(f"{torque:.3g}" for torque in self.typical_torque)
        return f"Scales({len(self.expected)} parameters, typical torque {torques} N·m)"

    @property
    def scale(self) -> FloatArray:
        """Scale of each parameter, (P,)."""
        return np.maximum(np.abs(self.expected), SIZE * self.parameter_scale)

    @classmethod
    def of(cls, model: TorqueModel, limits: MotionLimits, values: Mapping[str, float] | None = None) -> Scales:
        """Compute the scales over random states within the limits of angle.

        Args:
            model: Leg and terms.
            limits: Limits of angle.
            values: Expected parameters by name; None for those of the leg, and zero for terms.

        Returns:
            Scales of all parameters of the model.

        Raises:
            ExoidError: A name is unknown.
        """
        unknown = sorted(set(values or {}) - set(model.names))
        if unknown:
            raise ExoidError(
                f"no parameter {', '.join(unknown)} in the model", remedy=f"names are {', '.join(model.names)}"
            )
        expected = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True)) | dict(values or {})
        beta = np.array([expected.get(name, 0.0) for name in model.names])
        rng = np.random.default_rng(0)
        even = rng.uniform(-1.0, 1.0, (3, STATES, len(limits.lower)))
        q = 0.5 * (limits.lower + limits.upper) + 0.5 * limits.span * even[0]
        W = model.regressor(q, SPEED * even[1], ACCELERATION * even[2])
        tau = W @ beta
        r_factors = [factorize(np.column_stack([W[:, j], tau[:, j]]), STATES, STATES) for j in range(tau.shape[1])]
        return cls(beta, parameter_scale(r_factors), np.sqrt((tau**2).mean(axis=0)))
