"""The result of identifying several groups at once: an estimate of each, and what they share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.comparison import Comparison, wald, welch
from exoid.estimate.estimate import Estimate
from exoid.regression.diagnostics import verdict, verdict_beside
from exoid.regression.intervals import intervals
from exoid.regression.prior_knowledge import Assumed

from .equality import Equality
from .layout import Layout


@dataclass(frozen=True, eq=False, repr=False)
class Together:
    """Estimates of several groups of recordings that share parameters; prints itself as tables.

    ``together["left"]`` is the :class:`Estimate` of a group: its errors are correlated with those of the others.

    Attributes:
        estimates: One for each group, by its name.
        layout: Which parameters are shared.
        values: Of all parameters in the order of :attr:`names`, (P,).
        covariance: Of the values, (P, P).
        dofs: Degrees of freedom of each, (P,).
        sizes: Of parameters that would explain all torque of a joint alone, (P,).
        calm_sizes: The same had joints moved as in a calm exercise, (P,).
        collinearity: Condition index of each parameter, (P,).
        condition_number: Of the regressor of all with columns scaled to unit length.
        assumed: What was known beside the recordings, by the names here.
        bounded: Parameters that would have become negative and were kept at zero.
        equal: Whether own parameters are the same in all groups.
        agreement: Whether shared ones would be, were each group identified alone; None if one cannot be.
        warnings: What makes the estimates doubtful.
        notes: What else the reader should know.
    """

    estimates: Mapping[str, Estimate]
    layout: Layout
    values: FloatArray
    covariance: FloatArray
    dofs: FloatArray
    sizes: FloatArray
    calm_sizes: FloatArray
    collinearity: FloatArray
    condition_number: float
    assumed: Assumed
    equal: Equality
    agreement: Equality | None
    bounded: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Forbid changes."""
        object.__setattr__(self, "estimates", MappingProxyType(dict(self.estimates)))
        for name in ("values", "covariance", "dofs", "sizes", "calm_sizes", "collinearity"):
            array = np.array(getattr(self, name), dtype=np.float64)
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    def __getitem__(self, group: str) -> Estimate:
        """Look the estimate of a group up.

        Raises:
            ExoidError: There is no such group.
        """
        if group not in self.estimates:
            raise ExoidError(f"no group {group!r}", remedy=f"groups are {', '.join(self.groups)}")
        return self.estimates[group]

    def __iter__(self) -> Iterator[str]:
        """Go over the names of the groups."""
        return iter(self.groups)

    def __len__(self) -> int:
        """Number of groups."""
        return len(self.groups)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups."""
        return self.layout.groups

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters: shared ones, then each group's own, such as ``c0_hip[left]``."""
        return self.layout.names

    @property
    def units(self) -> tuple[str, ...]:
        """Their units."""
        return self.layout.units

    @property
    def shared(self) -> tuple[str, ...]:
        """Names of the shared parameters."""
        return self.names[: self.layout.shared]

    @property
    def own(self) -> tuple[str, ...]:
        """Names of the parameters that each group has of its own, without the group."""
        return self.layout.own

    @property
    def std(self) -> FloatArray:
        """Standard deviations, (P,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def verdicts(self) -> tuple[str, ...]:
        """How well each parameter is determined, see :attr:`Estimate.verdicts`."""
        numbers = zip(self.values, self.std, self.sizes, self.calm_sizes, self.collinearity, strict=True)
        return tuple(
            verdict_beside(name, self.assumed, each[1], verdict(*each))
            for name, each in zip(self.names, numbers, strict=True)
        )

    def interval(self, level: float = 0.95) -> FloatArray:
        """Confidence intervals by Student's t, (P, 2).

        Args:
            level: Probability that an interval contains the true value, between 0 and 1.

        Raises:
            ExoidError: The level is not between 0 and 1.
        """
        return intervals(self.values, self.std, self.dofs, level)

    def compare(self, first: str, second: str) -> Comparison:
        """Test whether own parameters of two groups differ; errors that they have in common cancel.

        As :func:`exoid.compare`, with cov(β₂ − β₁) = C₁₁ + C₂₂ − C₁₂ − C₂₁ of the joint covariance.

        Args:
            first: Name of a group.
            second: Name of another.

        Raises:
            ExoidError: There is no such group, or it has no parameters of its own.
        """
        for group in (first, second):
            self[group]
        if first == second or not self.own:
            what = f"{first} twice" if first == second else f"{first} and {second} share every parameter"
            raise ExoidError(f"nothing to compare: {what}", remedy="name two groups with parameters of their own")
        one, other = ([self.layout.place(n, self.groups.index(g)) for n in self.own] for g in (first, second))
        C = self.covariance
        crossed = C[np.ix_(one, other)]
        covariance = C[np.ix_(one, one)] + C[np.ix_(other, other)] - crossed - crossed.T
        variances = np.diag(C)
        dof = welch(variances[one], variances[other], self.dofs[one], self.dofs[other])
        units = tuple(self.units[k] for k in one)
        least = min(self[group].dof for group in (first, second))
        return wald(self.own, units, self.values[other] - self.values[one], covariance, dof, least)

    def __repr__(self) -> str:
        """Name groups and parameters."""
        return f"Together({', '.join(self.groups)}; shared: {', '.join(self.shared)}; own: {', '.join(self.own)})"

    def __str__(self) -> str:
        """Print as tables, followed by what the reader should know before trusting them."""
        from .report import report  # noqa: PLC0415 - it needs this class

        return report(self)
