"""Constants of drives that a fit has found, which the torque is not linear in."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.diagnostics import identifiability_class
from exoid.regression.intervals import half_width

from .evidence import freeze


@dataclass(frozen=True, eq=False)
class NonlinearParameters:
    """Constants of drives, such as a torque constant, with their uncertainty.

    Attributes:
        names: Symbol and joint, such as kt_hip, (S,).
        units: Their units.
        values: (S,).
        covariance: Covariance of the values (Gauss and Newton), (S, S); zero for those that are held.
        held: Constants that stand at a bound.
        doubtful: Constants that a finding makes doubtful.
    """

    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    values: FloatArray = field(default_factory=lambda: np.zeros(0))
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    held: tuple[str, ...] = ()
    doubtful: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Check sizes and forbid changes."""
        count = len(self.names)
        freeze(self, {"values": (count,), "covariance": (count, count)})

    def __len__(self) -> int:
        """Number of constants."""
        return len(self.names)

    @property
    def std(self) -> FloatArray:
        """Standard deviations, (S,); 0 for those that are held."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def identifiability(self) -> tuple[str, ...]:
        """How well each is determined: "well", "weakly", "not" or "held"."""
        numbers = zip(self.values, self.std, strict=True)
        pairs = zip(self.names, (identifiability_class(value, std, 0.0) for value, std in numbers), strict=True)
        classes = ((name, "held" if name in self.held else found) for name, found in pairs)
        return tuple("weakly" if name in self.doubtful and found == "well" else found for name, found in classes)

    def interval(self, dof: float) -> FloatArray:
        """95 % confidence intervals, (S, 2), of Student's t for the logarithms, as constants are positive.

        Args:
            dof: Degrees of freedom of the estimate.

        Returns:
            Lower and upper ends, (S, 2).
        """
        half = half_width(0.95, dof) * self.std / self.values
        return np.column_stack([self.values * np.exp(-half), self.values * np.exp(half)])


NO_NONLINEAR_PARAMETERS = NonlinearParameters()  # of a model that is linear in all parameters
