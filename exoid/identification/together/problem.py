"""The rows of several groups of recordings, each of its own model, as one problem."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.identification.problem import Block, Kind, Problem
from exoid.regression.influence import weighted
from exoid.regression.least_squares import Solution, solve
from exoid.regression.prior_knowledge import Assumed
from exoid.regression.r_factor import Triangle, join
from exoid.regression.residuals import Noises

from .layout import Layout

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class JointProblem:
    """τ_g = W_g β[places of g] over groups g; joints, and so noise and weights, are counted through all groups.

    Attributes:
        problems: One for each group.
        layout: Where their parameters stand.
        assumed: What is known beside the rows, by the names of the layout.
    """

    problems: tuple[Problem, ...]
    layout: Layout
    assumed: Assumed

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters."""
        return self.layout.names

    def solve(self, triangle: Triangle) -> Solution:
        """Solve for weighted rows, with what is known beside them."""
        return self._solve(triangle, self.assumed)

    @cached_property
    def nonnegative(self) -> NDArray[np.bool_]:
        """Which parameters cannot be negative in nature, (P,)."""
        never = np.zeros(len(self.names), dtype=np.bool_)
        for places, problem in zip(self.layout.places, self.problems, strict=True):
            never[places] |= problem.model.nonnegative
        return never

    @cached_property
    def triangles(self) -> list[Triangle]:
        """Triangles of all groups, group by group, with a column for every parameter."""
        pairs = enumerate(self.problems)
        return [self.widened(triangle, group) for group, problem in pairs for triangle in problem.triangles]

    @cached_property
    def columns(self) -> list[NDArray[np.intp]]:
        """Parameters that can act on each joint, as indices."""
        pairs = zip(self.layout.places, self.problems, strict=True)
        return [places[columns] for places, problem in pairs for columns in problem.columns]

    def weight_index(self, kind: Kind, joint: int) -> int:
        """Place among :attr:`triangles` of the one that holds the rows of a kind and joint."""
        group = int(np.searchsorted(self._joints, joint, side="right")) - 1
        return int(self._triangles[group]) + self.problems[group].weight_index(kind, joint - int(self._joints[group]))

    def blocks(self, *, thinned: bool = False) -> Iterator[Block]:
        """Go over the rows, group by group; columns are those of the group's own model."""
        for first, problem in zip(self._joints, self.problems, strict=False):
            for block in problem.blocks(thinned=thinned):
                yield block._replace(first=int(first))
            problem.forget()  # or memory would hold the kinematics of a recording of each group

    def gather(self, work: Callable[[Iterable[Block]], T]) -> Iterator[T]:
        """Let work go over the thinned rows of each recording, group by group, and bring back what it finds."""
        for first, problem in zip(self._joints, self.problems, strict=False):
            yield from problem.gather(partial(_work_from, work, int(first)))
            problem.forget()

    def widened(self, triangle: Triangle, group: int) -> Triangle:
        """Put the columns of a triangle of one group where its parameters stand."""
        count = len(self.names)
        return triangle.among(np.append(self.layout.places[group], count), count + 1)

    def weights_of(self, group: int, weights: Sequence[float]) -> list[float]:
        """Weights of the triangles of one group."""
        return list(weights[self._triangles[group] : self._triangles[group + 1]])

    def noises_of(self, group: int, noises: Noises) -> Noises:
        """Noise of the joints of one group, by their index there."""
        first, end = self._joints[group], self._joints[group + 1]
        return {(kind, joint - int(first)): n for (kind, joint), n in noises.items() if first <= joint < end}

    def rows_of(self, group: int, weights: Sequence[float]) -> Triangle:
        """Weighted rows of one group."""
        return self.widened(join(self.problems[group].triangles, self.weights_of(group, weights)), group)

    def recordings(self, weights: Sequence[float]) -> list[Triangle]:
        """Weighted rows of each recording, group by group."""
        return [
            self.widened(weighted(problem, index, self.weights_of(group, weights)), group)
            for group, problem in enumerate(self.problems)
            for index in range(len(problem.data))
        ]

    def without(self, index: int, others: Triangle, values: FloatArray) -> FloatArray:
        """Solve without one of the recordings; a group that has no other then loses what is its own.

        Args:
            index: Of the recording.
            others: Weighted rows of the others.
            values: With all of them, (P,).

        Returns:
            Values, infinite for what was lost.
        """
        group = [g for g, problem in enumerate(self.problems) for _ in problem.each][index]
        if len(self.problems[group].data) > 1:
            return self.solve(others).values
        places = [self.layout.place(name, group) for name in self.layout.own]
        lost = [k for k in places if self.names[k] not in self.assumed.names]
        known = {**self.assumed.known, **{self.names[k]: float(values[k]) for k in lost}}
        found = self._solve(others, replace(self.assumed, known=known)).values.copy()
        found[lost] = np.inf
        return found

    def _solve(self, triangle: Triangle, assumed: Assumed) -> Solution:
        return solve(triangle, self.names, assumed, self.nonnegative if assumed.nonnegative else None)

    @cached_property
    def _joints(self) -> NDArray[np.intp]:
        """First joint of each group, and how many there are in all."""
        return np.cumsum([0, *(len(problem.columns) for problem in self.problems)])

    @cached_property
    def _triangles(self) -> NDArray[np.intp]:
        """First triangle of each group, and how many there are in all."""
        return np.cumsum([0, *(len(problem.triangles) for problem in self.problems)])


def _work_from(work: Callable[[Iterable[Block]], T], first: int, blocks: Iterable[Block]) -> T:
    """Count joints from that one on."""
    return work(block._replace(first=first) for block in blocks)
