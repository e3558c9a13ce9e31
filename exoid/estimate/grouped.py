"""The result of identifying several groups at once: an estimate of each, and what they share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.regression.parameters import ParameterLayout, PriorKnowledge
from exoid.tools.json_values import named
from exoid.tools.tables import DataTable, Report, make_table

from .comparison import SIGNIFICANT, Comparison, Equality, wald, welch
from .estimate import Estimate
from .evidence import Evidence, freeze
from .finding import Finding
from .parameter import ParameterTable
from .text import HEADERS, assumptions, condition, number_rows, numbers_to_json


@dataclass(frozen=True, eq=False, repr=False)
class GroupedEstimate(Report, ParameterTable):
    """Estimates of several groups of recordings that share parameters; prints itself as tables.

    ``grouped["left"]`` is the :class:`Estimate` of a group: its errors are correlated with those of the others.

    Attributes:
        estimates: One for each group, by its name.
        layout: Parameter layout: which parameters are shared.
        values: Values of all parameters in the order of :attr:`names`, (P,).
        covariance: Covariance of the values, (P, P).
        evidence: Degrees of freedom and scales of all parameters, the reference scale the smallest of all groups.
        dof: Independent samples of all groups less parameters.
        condition_number: Condition number of the regressor of all groups with columns scaled to unit length.
        prior_knowledge: Known parameters, priors and signs, by the names here.
        equal: Test whether own parameters are the same in all groups.
        agreement: Test whether shared parameters are the same where each group is identified alone; None without it.
        warnings: Reasons to doubt the estimates.
        notes: Notes for the reader.
    """

    estimates: Mapping[str, Estimate]
    layout: ParameterLayout
    values: FloatArray
    covariance: FloatArray
    evidence: Evidence
    dof: float
    condition_number: float
    prior_knowledge: PriorKnowledge
    equal: Equality
    agreement: Equality | None
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Forbid changes."""
        object.__setattr__(self, "estimates", MappingProxyType(dict(self.estimates)))
        count = len(self.names)
        freeze(self, {"values": (count,), "covariance": (count, count)})
        self.evidence.check(count, 0)

    def __getitem__(self, group: str) -> Estimate:
        """Look the estimate of a group up.

        Args:
            group: Name of the group.

        Returns:
            Its estimate.

        Raises:
            ExoidError: There is no such group.
        """
        if group not in self.estimates:
            raise BadArgumentError(f"no group {group!r}", remedy=f"groups are {', '.join(self.groups)}")
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
    def findings(self) -> tuple[Finding, ...]:
        """Findings of all groups, group by group."""
        return tuple(finding for estimate in self.estimates.values() for finding in estimate.findings)

    @property
    def doubtful(self) -> frozenset[str]:
        """Parameters that a finding of some group makes doubtful."""
        return frozenset(
            self.names[place]
            for places, estimate in zip(self.layout.places, self.estimates.values(), strict=True)
            for name, place in zip(estimate.names, places, strict=False)
            if name in estimate.doubtful
        )

    def compare(self, first: str, second: str) -> Comparison:
        """Test whether own parameters of two groups differ; errors that they have in common cancel.

        As :func:`exoid.compare`, with cov(β₂ − β₁) = C₁₁ + C₂₂ − C₁₂ − C₂₁ of the joint covariance.

        Args:
            first: Name of a group.
            second: Name of another.

        Returns:
            Differences with their tests.

        Raises:
            ExoidError: There is no such group, or it has no parameters of its own.
        """
        for group in (first, second):
            self[group]
        if first == second or not self.own:
            what = f"{first} twice" if first == second else f"{first} and {second} share every parameter"
            raise BadArgumentError(f"nothing to compare: {what}", remedy="name two groups with parameters of their own")
        one, other = ([self.layout.place(n, self.groups.index(g)) for n in self.own] for g in (first, second))
        C = self.covariance
        crossed = C[np.ix_(one, other)]
        covariance = C[np.ix_(one, one)] + C[np.ix_(other, other)] - crossed - crossed.T
        variances = np.diag(C)
        dof = welch(variances[one], variances[other], self.dof_each[one], self.dof_each[other])
        units = tuple(self.units[k] for k in one)
        least = min(self[group].dof for group in (first, second))
        return wald(self.own, units, self.values[other] - self.values[one], covariance, dof, least)

    def to_json(self) -> dict[str, Any]:
        """Turn estimates that share parameters into what JSON can hold.

        Returns:
            Shared and own parameters, tests, and the estimate of each group.
        """
        return {
            **numbers_to_json(self, self.interval()),
            "degrees_of_freedom": named(self.names, self.dof_each),
            "shared": list(self.shared),
            "own": list(self.own),
            "condition_number": self.condition_number,
            "covariance": self.covariance.tolist(),
            "equal": _equality_to_json(self.equal),
            "agreement": None if self.agreement is None else _equality_to_json(self.agreement),
            "warnings": list(self.warnings),
            "notes": list(self.notes),
            "groups": {group: self[group].to_json() for group in self},
        }

    def __repr__(self) -> str:
        """Name groups and parameters."""
        return (
            f"GroupedEstimate({', '.join(self.groups)}; shared: {', '.join(self.shared)}; own: {', '.join(self.own)})"
        )

    def _report(self) -> list[DataTable | str]:
        """Tables of shared and own parameters, followed by what the reader should know before trusting them."""
        kind = next(iter(self.estimates.values())).estimator
        title = f"{', '.join(self.groups)}: {kind} estimate of {len(self.shared)} shared parameters"
        parts: list[DataTable | str] = [f"{title}, {len(self.own)} own each"]
        numbers = {name: cells for name, *cells in number_rows(self, self.interval())}
        headers = HEADERS[1:]
        if self.shared:
            rows = [(name, *numbers[name]) for name in self.shared]
            parts.append(make_table(("shared", *headers), rows))
        if self.own:  # side by side, with the probability that they are the same in all groups
            rows = []
            for k, name in enumerate(self.own):
                for group in range(len(self)):
                    place = self.names[self.layout.place(name, group)]
                    p = f"{self.equal.p_values[k]:.3f}" if group == 0 and len(self) > 1 else ""
                    rows.append((place, *numbers[place], p))
            parts.append(make_table(("own", *headers, "p equal"), rows))
        return [*parts, *_closing_lines(self)]


def _closing_lines(grouped: GroupedEstimate) -> Iterator[str]:
    for group in grouped:
        estimate = grouped[group]
        residuals = zip(estimate.joint_names, estimate.residual_rms, estimate.trained, strict=True)
        each = (f"{joint} {f'{rms:.3g}' if there else 'not measured'}" for joint, rms, there in residuals)
        yield f"residual RMS of {group} [{estimate.model.torque_unit}]: {', '.join(each)}"
    yield condition(grouped.condition_number)
    if grouped.own and len(grouped) > 1:
        yield f"own parameters that differ at 5 % of all: {', '.join(grouped.equal.below(SIGNIFICANT)) or 'none'}"
    if grouped.agreement is not None and grouped.shared:
        least = float(grouped.agreement.adjusted.min())
        yield f"shared parameters, each group alone: the smallest p of {len(grouped.shared)} is {least:.2g} (Holm)"
    yield from assumptions(grouped.prior_knowledge, grouped.bounded)
    yield from (f"{group}: {line}" for group in grouped for line in grouped[group].findings)
    yield from (f"warning: {warning}" for warning in grouped.warnings)
    yield from (f"note: {note}" for note in grouped.notes)


def _equality_to_json(equality: Equality) -> dict[str, Any]:
    return {key: named(equality.names, getattr(equality, key)) for key in ("p_values", "adjusted")}
