"""Scales for the standard deviations of the parameters of a machine that stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.experiments.excitation.fourier import States
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.scales import ACCELERATION, SPEED, STATES, Scales
from exoid.regression.diagnostics import parameter_scale
from exoid.regression.least_squares import factorize
from exoid.torques import TorqueModel

from .demands import Demands


def expected_parameters(model: TorqueModel, values: Mapping[str, float] | None) -> FloatArray:
    """Take expected parameters of a machine."""
    unknown = sorted(set(values or {}) - set(model.names))
    if unknown:
        raise ExoidError(
            f"no parameter {', '.join(unknown)} in the model", remedy=f"names are {', '.join(model.names)}"
        )
    expected = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True)) | dict(values or {})
    return np.array([expected.get(name, 0.0) for name in model.names])


def stance_scales(model: TorqueModel, demands: Sequence[Demands], limits: Sequence[MotionLimits]) -> Scales:
    """Compute the scales over random states of standing on each foot, see :class:`Scales`."""
    rng, tables = np.random.default_rng(0), []
    expected = demands[0].expected
    for one, box in zip(demands, limits, strict=True):
        even = rng.uniform(-1.0, 1.0, (3, STATES, len(box.lower)))
        y = 0.5 * (box.lower + box.upper) + 0.5 * box.span * even[0]
        states = States(y, SPEED * even[1], ACCELERATION * even[2])
        inverse = np.linalg.inv(one.support.spread)  # of one foot: a permutation of the joints
        tables.append(np.einsum("jk,pks->sjp", inverse, one.at(states).columns))
    W = np.vstack(tables)
    tau = W @ expected
    factors = [factorize(np.column_stack([W[:, j], tau[:, j]]), len(W), len(W)) for j in range(tau.shape[1])]
    return Scales(expected, parameter_scale(factors), np.sqrt((tau**2).mean(axis=0)))
