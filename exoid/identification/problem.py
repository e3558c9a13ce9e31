"""Regression problem of one or several groups of recordings, each with a torque model of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.estimate.finding import Finding
from exoid.estimate.nonlinear import NO_NONLINEAR_PARAMETERS, NonlinearParameters
from exoid.regression.least_squares import RFactor, Solution, solve
from exoid.regression.parameters import NO_PRIOR_KNOWLEDGE, ParameterLayout, PriorKnowledge
from exoid.regression.problem import Fit
from exoid.regression.row_data import NoiseKind, RowBlock
from exoid.regression.rows import rate_class
from exoid.signals import Recording
from exoid.torques import Term, TorqueModel

from .group_rows import Group


@dataclass(frozen=True, eq=False)
class Problem:
    """τ_g = W_g β[places of g] over groups g; one group is the usual case."""

    # Joints, and so noise and weights, are counted through all groups. Recordings with contacts are one group for each
    # set of links that rest: groups of one name have one leg, and the same parameters.

    groups: tuple[Group, ...]  # recordings and rows of each group
    own: tuple[str, ...] = ()  # names of parameters that each group has of its own
    given: PriorKnowledge = NO_PRIOR_KNOWLEDGE  # known parameters, priors and signs, as they were given
    terms: tuple[Term, ...] = ()  # terms of the models

    @cached_property
    def layout(self) -> ParameterLayout:
        """Parameter layout: indices of the parameters of each group in β."""
        model, names = self.groups[0].model, dict.fromkeys(group.name for group in self.groups)
        return ParameterLayout.of(tuple(names), model.names, model.units, self.own)

    @cached_property
    def prior_knowledge(self) -> PriorKnowledge:
        """Known parameters, priors and signs, by the names of the layout."""
        return self.layout.spread(self.given)

    @property
    def motions(self) -> list[Recording]:
        """Recordings of all groups."""
        return [one for group in self.groups for one in group.motions]

    def parts(self, name: str) -> list[int]:
        """Places of the groups of one name: with contacts there is one for each set of links that rest."""
        return [k for k, group in enumerate(self.groups) if group.name == name]

    @cached_property
    def places(self) -> list[NDArray[np.intp]]:
        """Indices in β of the parameters of each group's model."""
        return [self.layout.places[self.layout.groups.index(group.name)] for group in self.groups]

    @property
    def single(self) -> Group:
        """The only group."""
        if len(self.groups) > 1:
            what = "this estimator is for one leg alone, and there are several groups"
            raise NotSupportedError(what, remedy="use one of huber, ols, wls")
        return self.groups[0]

    def changed(self, **changes: object) -> Problem:
        """Return the same problem with other data, model or preparation of all groups."""
        return replace(self, groups=tuple(replace(group, **changes) for group in self.groups))  # type: ignore[arg-type]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters."""
        return self.layout.names

    def solve(self, r_factor: RFactor) -> Solution:
        """Solve for weighted rows, with what is known beside them."""
        never = None
        if self.given.nonnegative:
            never = np.zeros(len(self.names), dtype=np.bool_)
            for places, group in zip(self.places, self.groups, strict=True):
                never[places] |= group.model.nonnegative
        return solve(r_factor, self.names, self.prior_knowledge, never)

    @cached_property
    def r_factors(self) -> list[RFactor]:
        """R factors of all groups, group by group, with a column for every parameter."""
        count, widened = len(self.names), []
        for places, group in zip(self.places, self.groups, strict=True):
            here, own = np.array_equal(places, np.arange(count)), np.append(places, count)
            widened += [each if here else each.among(own, count + 1) for each in group.r_factors]
        return widened

    @cached_property
    def columns(self) -> list[NDArray[np.intp]]:
        """Parameters that can act on each joint, as indices."""
        pairs = zip(self.places, self.groups, strict=True)
        return [places[np.flatnonzero(acting)] for places, group in pairs for acting in group.model.acting]

    def weight_index(self, kind: NoiseKind, joint: int) -> int:
        """Place among :attr:`r_factors` of the one that holds the rows of a kind and joint."""
        first_joints, first_factors = self.starts
        k = int(np.searchsorted(first_joints, joint, side="right")) - 1
        count, factors = np.diff(self.starts)[:, k].tolist()
        behind = count if kind.at_rest and factors > count else 0  # those of poses, if there are others
        return int(first_factors[k]) + joint - int(first_joints[k]) + behind

    def blocks(self) -> Iterator[RowBlock]:
        """Go over all rows, group by group; columns are those of the group's own model."""
        for first, group in zip(self.starts[0].tolist(), self.groups, strict=False):
            for index in range(len(group.data)):
                for rows in group.rows_of(index):
                    yield RowBlock(NoiseKind(group.at_rest(index), rate_class(rows.time)), rows, first)

    def recordings(self) -> Iterator[RowBlock]:
        """Go over the recordings, group by group: the decimated rows of each."""
        for first, group in zip(self.starts[0].tolist(), self.groups, strict=False):
            for index in range(len(group.data)):
                rows = group.decimated(index)
                yield RowBlock(NoiseKind(group.at_rest(index), rate_class(rows.time)), rows, first)

    @cached_property
    def starts(self) -> NDArray[np.intp]:
        """First joint, and first R factor, of each group, and how many there are in all, (2, G + 1)."""
        counts = [(len(group.model.row_names), len(group.r_factors)) for group in self.groups]
        return np.cumsum([(0, 0), *counts], axis=0).T


class Fitted(NamedTuple):
    """A fit to a problem."""

    problem: Problem  # rows, about the solution linear in β and in the constants of drives that are not held
    fit: Fit  # solution in both
    models: tuple[TorqueModel, ...]  # torque model of each group, loaded by the fitted rigid bodies
    warnings: tuple[str, ...]  # warnings for the reader
    nonlinear: NonlinearParameters = NO_NONLINEAR_PARAMETERS  # constants of drives that were found, without covariance
    doubt: FloatArray | None = None  # covariance by errors of numbers beside the parameters, (P, P)
    findings: tuple[Finding, ...] = ()  # what the fit shows, beside the findings of each group

    def values(self, group: int) -> FloatArray:
        """Parameters of one group's model, (P,)."""
        return self.fit.solution.values[self.problem.places[group][: len(self.models[group].names)]]
