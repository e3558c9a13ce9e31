"""Parameters with their uncertainty: one by name, and a table of all."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.regression.diagnostics import identifiability_beside, identifiability_class
from exoid.regression.intervals import intervals
from exoid.regression.parameters import PriorKnowledge

from .evidence import Evidence


class Parameter(NamedTuple):
    """Identified parameter with its uncertainty.

    Attributes:
        name: Name, such as "X1" or "c0_hip".
        value: Value.
        std: Standard deviation; 0 for a parameter that was held fixed.
        interval: Lower and upper end of the 95 % confidence interval.
        unit: Unit of all these numbers.
        identifiability: "well", "weakly", "not", "known", "prior" or "held", see
            :attr:`exoid.Estimate.identifiability`.
    """

    name: str
    value: float
    std: float
    interval: tuple[float, float]
    unit: str
    identifiability: str

    def __str__(self) -> str:
        """Print as ``X1 = 3.986 ± 0.0063 kg·m``."""
        return f"{self.name} = {self.value:.6g} ± {self.std:.2g} {self.unit}"


class ParameterTable(ABC):
    """Values of parameters with their covariance, and what follows from these."""

    values: FloatArray  # values in the order of `names`, (P,)
    covariance: FloatArray  # covariance of the values, (P, P)
    dof: float  # independent samples less parameters
    prior_knowledge: PriorKnowledge  # known parameters, priors and signs
    evidence: Evidence  # what recordings say beside the values

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, (P,)."""

    @property
    @abstractmethod
    def units(self) -> tuple[str, ...]:
        """Units of the parameters, (P,)."""

    @property
    def dof_each(self) -> FloatArray:
        """Degrees of freedom of each parameter's variance, (P,): those of the estimate where no others are known."""
        known = self.evidence.dof_each
        return np.full(len(self.names), self.dof) if known is None else known

    @property
    def parameter_scale(self) -> FloatArray:
        """Value of each parameter that alone would explain all torque of a joint, (P,); 0 where it is not known."""
        known = self.evidence.parameter_scale
        return np.zeros(len(self.names)) if known is None else known

    @property
    def reference_scale(self) -> FloatArray:
        """The parameter scale in a calm exercise at the same angles, (P,); infinite where it is not known."""
        known = self.evidence.reference_scale
        return np.full(len(self.names), np.inf) if known is None else known

    @property
    def collinearity(self) -> FloatArray:
        """Condition index of each parameter, (P,); 1 where it is not known."""
        known = self.evidence.collinearity
        return np.ones(len(self.names)) if known is None else known

    @property
    def bounded(self) -> tuple[str, ...]:
        """Parameters that would have become negative and were kept at zero."""
        return self.evidence.bounded

    @property
    def doubtful(self) -> frozenset[str]:
        """Parameters that a finding makes doubtful: they are at best weakly determined."""
        return frozenset()

    @property
    def std(self) -> FloatArray:
        """Standard deviations, (P,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the errors of any two parameters, (P, P)."""
        std = np.where(self.std > 0.0, self.std, 1.0)
        correlation = self.covariance / np.multiply.outer(std, std)
        np.fill_diagonal(correlation, 1.0)
        return np.asarray(correlation)

    @property
    def identifiability(self) -> tuple[str, ...]:
        """How well each parameter is determined: "well", "weakly" or "not"; or "known", or "prior".

        Well if the standard deviation is at most 10 % of the value, weakly if at most 30 %. For values near zero it is
        10 and 30 % of a tenth of the value that would explain all torque of a joint alone, in these recordings or in a
        calm exercise. Known is what was held fixed, and prior what the prior knows better than the recordings. A value
        that would give three times all torque of a joint is not determined: it only cancels another. And what moves
        together with others is at best weakly determined from a condition index of 100 on, and not from 300 on. A
        parameter that a finding makes doubtful is at best weakly determined.
        """
        numbers = zip(self.values, self.std, self.parameter_scale, self.reference_scale, self.collinearity, strict=True)
        classes = (
            (name, identifiability_beside(name, self.prior_knowledge, each[1], identifiability_class(*each)))
            for name, each in zip(self.names, numbers, strict=True)
        )
        doubtful = self.doubtful
        return tuple("weakly" if name in doubtful and found == "well" else found for name, found in classes)

    def interval(self, level: float = 0.95) -> FloatArray:
        """Confidence intervals by Student's t with the degrees of freedom of each parameter, (P, 2).

        Args:
            level: Probability that an interval contains the true value, between 0 and 1.

        Returns:
            Lower and upper ends, (P, 2).

        Raises:
            ExoidError: The level is not between 0 and 1.
        """
        return intervals(self.values, self.std, self.dof_each, level)

    def parameter(self, name: str) -> Parameter:
        """Look up one parameter by name.

        Args:
            name: Name of the parameter.

        Returns:
            Value, standard deviation, 95 % interval, unit and identifiability.

        Raises:
            ExoidError: There is no such parameter.
        """
        if name not in self.names:
            raise BadArgumentError(f"no parameter {name!r}", remedy=f"names are {', '.join(self.names)}")
        k = self.names.index(name)
        low, high = self.interval()[k]
        value, std, interval = float(self.values[k]), float(self.std[k]), (float(low), float(high))
        return Parameter(name, value, std, interval, self.units[k], self.identifiability[k])
