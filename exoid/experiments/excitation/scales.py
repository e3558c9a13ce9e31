"""Torque noise of a prediction, and scales for the standard deviations of the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import MotionLimits
from exoid.experiments.references import States
from exoid.leg.joint_numbers import for_joints
from exoid.regression.diagnostics import SIZE, parameter_scale
from exoid.regression.least_squares import factorize
from exoid.tools.numbers import checked
from exoid.torques import TorqueModel

STATES = 4000
"""Number of reference states."""


@dataclass(frozen=True)
class TorqueNoise:
    """Noise of the logged torque signals.

    Attributes:
        std: Standard deviation at each joint [N·m].
        bandwidth: Frequency up to which the spectrum is flat [Hz]; inf for white noise. Noise of bandwidth b has 2 b
            independent samples a second at any rate of the log.
        assumed: Whether the standard deviations are default values.
        unit: Unit of the torques; N of slides.

    Raises:
        ExoidError: A standard deviation or the bandwidth is not positive.
    """

    std: tuple[float, ...]
    bandwidth: float = np.inf
    assumed: bool = False
    unit: str = "N·m"

    def __post_init__(self) -> None:
        """Check the numbers."""
        checked(self.std, "torque noise", above=0.0)
        checked(self.bandwidth, "the bandwidth of the torque noise", above=0.0, infinite=True)

    @classmethod
    def of(
        cls, std: ArrayLike | None, typical: FloatArray, bandwidth: float = np.inf, unit: str = "N·m"
    ) -> TorqueNoise:
        """Take given standard deviations, a number or (n,), or 2 % of the typical torque of each joint."""
        each = 0.02 * typical if std is None else for_joints(std, len(typical), "torque noise")
        return cls(tuple(each.tolist()), bandwidth, std is None, unit)

    def per_sample(self, rate: float) -> FloatArray:
        """Compute the standard deviation of white noise of the same spectral density at a rate, σ √(rate / 2b)."""
        return np.asarray(np.array(self.std) * np.sqrt(max(1.0, rate / (2.0 * self.bandwidth))))

    def __str__(self) -> str:
        """Write standard deviations and bandwidth."""
        stds = ", ".join(f"{std:.2g}" for std in self.std)
        band = "white" if np.isinf(self.bandwidth) else f"up to {self.bandwidth:g} Hz"
        return f"{stds} {self.unit} ({band}{', assumed' if self.assumed else ''})"


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

    @property
    def scale(self) -> FloatArray:
        """Scale of each parameter, (P,)."""
        return np.maximum(np.abs(self.expected), SIZE * self.parameter_scale)

    @classmethod
    def of(cls, model: TorqueModel, limits: MotionLimits, values: Mapping[str, float] | None = None) -> Scales:
        """Compute the scales over random states within the limits of angle."""
        expected = expected_parameters(model, values)
        states = reference_states(limits, STATES, np.random.default_rng(0))
        return cls.over(expected, model.regressor(*states))

    @classmethod
    def over(cls, expected: FloatArray, W: FloatArray) -> Scales:
        """Compute the scales over the regressor at reference states, (S, n, P)."""
        tau = W @ expected
        r_factors = [factorize(np.column_stack([W[:, j], tau[:, j]]), len(W), len(W)) for j in range(tau.shape[1])]
        return cls(expected, parameter_scale(r_factors), np.sqrt((tau**2).mean(axis=0)))


def expected_parameters(model: TorqueModel, values: Mapping[str, float] | None) -> FloatArray:
    """Take expected parameters by name, else those of the leg; zero for terms."""
    unknown = sorted(set(values or {}) - set(model.names))
    if unknown:
        raise BadArgumentError(
            f"no parameter {', '.join(unknown)} in the model",
            parameters=tuple(unknown),
            remedy=f"names are {', '.join(model.names)}",
        )
    expected = dict(zip(model.leg.parameter_names, model.leg.parameters.tolist(), strict=True)) | dict(values or {})
    return np.array([expected.get(name, 0.0) for name in model.names])


def reference_states(limits: MotionLimits, count: int, rng: np.random.Generator) -> States:
    """Draw states at all angles within the limits; velocities and accelerations are those of a swing of ±9° at 1 Hz."""
    even = rng.uniform(-1.0, 1.0, (3, count, len(limits.lower)))
    q = 0.5 * (limits.lower + limits.upper) + 0.5 * limits.span * even[0]
    return States(q, even[1], 2.0 * np.pi * even[2])
