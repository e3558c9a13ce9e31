"""What the standard deviation of each parameter is compared with."""

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
"""Drawn to see what torques are typical."""

SPEED, ACCELERATION = 1.0, 2.0 * np.pi
"""Up to which joints are moved there [rad/s, rad/s²], as in calm exercises: 1 Hz, ±9°."""


class Scales(NamedTuple):
    """Expected parameters, and the scale of each, whatever the motion.

    A relative standard deviation is std / scale with scale = max(|expected value|, size / 10). The size of a parameter
    is the value that would explain, alone, all torque of a joint it acts on, as in
    :attr:`exoid.Estimate.identifiability`; but
    over calm states at all angles, so that two motions are judged alike. The floor keeps parameters near zero (Y, an
    offset, friction nobody knows yet) from being called badly known however precise they are.

    Attributes:
        values: Expected parameters, (P,).
        sizes: (P,).
        typical: Root mean square of the torque at each joint over those states [N·m], (n,).
    """

    values: FloatArray
    sizes: FloatArray
    typical: FloatArray

    @property
    def scale(self) -> FloatArray:
        """Scale of each parameter, (P,)."""
        return np.maximum(np.abs(self.values), SIZE * self.sizes)

    @classmethod
    def of(cls, model: TorqueModel, limits: MotionLimits, values: Mapping[str, float] | None = None) -> Scales:
        """Draw states from all over the limits of angle and look at their torques.

        Args:
            model: Leg and terms.
            limits: Of angles.
            values: Expected parameters by name; those of the leg otherwise, and zero for terms.

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
