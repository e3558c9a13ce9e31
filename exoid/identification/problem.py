"""Regression problem of one or several groups of recordings, each with a torque model of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError, NotSupportedError, within
from exoid.regression.least_squares import RFactor, Solution, solve, stack
from exoid.regression.parameters import NO_PRIOR_KNOWLEDGE, ParameterLayout, PriorKnowledge
from exoid.regression.row_data import NoiseKind, RowBlock
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import TorqueModel

from .group_rows import Group, GroupRows, Keep

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Problem:
    """τ_g = W_g β[places of g] over groups g; one group is the usual case."""

    # Joints, and so noise and weights, are counted through all groups.

    groups: tuple[GroupRows, ...]  # rows of each group
    layout: ParameterLayout  # parameter layout: indices of the parameters of each group in β
    # known parameters, priors and signs, by the names of the layout
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE

    @classmethod
    def of(
        cls,
        groups: Sequence[Group],
        models: Sequence[TorqueModel],
        own: Sequence[str] = (),
        prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE,
        keep: Keep | None = None,
    ) -> Problem:
        """Form the regression problem of groups of recordings."""
        rows = tuple(
            GroupRows(model, group.data, group.chosen_preparation, keep, 1.0 / len(groups), group.unmeasured)
            for model, group in zip(models, groups, strict=True)
        )
        layout = ParameterLayout.of([group.name for group in groups], models[0].names, models[0].units, own)
        return cls(rows, layout, layout.spread(prior_knowledge))

    @classmethod
    def of_one(cls, rows: GroupRows, prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE) -> Problem:
        """Make the problem of one group, whose parameters are those of its model."""
        return cls((rows,), ParameterLayout.of(("",), rows.model.names, rows.model.units), prior_knowledge)

    @property
    def single(self) -> GroupRows:
        """Rows of the only group."""
        self.refuse_several_groups()
        return self.groups[0]

    def refuse_several_groups(self) -> None:
        """Refuse several groups of recordings."""
        if len(self.groups) > 1:
            raise NotSupportedError(
                "this estimator is for one leg alone, and there are several groups",
                remedy="use one of gls, huber, ols, wls",
            )

    def refuse_moving_base(self, estimator: str) -> None:
        """Refuse recordings whose base moves, for estimators that simulate the leg."""
        moving = next((data for data in self.local_data if isinstance(data, Recording) and data.base), None)
        if moving is not None:
            raise NotSupportedError(
                f"{estimator} simulates the leg on a base at rest, and the base moves in a recording",
                where=moving.source.name if moving.source else "",
                remedy="use wls",
            )

    def refuse_payloads(self, estimator: str) -> None:
        """Refuse recordings with payloads, for estimators that do not fit the rows."""
        loaded = next((data for data in self.local_data if data.payloads), None)
        if loaded is not None:
            raise NotSupportedError(
                f"{estimator} fits the leg without payloads, and a recording has {loaded.payloads[0]}",
                where=loaded.source.name if loaded.source else "",
                remedy="use wls, huber, gls or ols",
            )

    def refuse_loaded_links(self, estimator: str) -> None:
        """Refuse recordings with wrenches or contacts, for estimators that do not fit the rows."""
        loaded = next((data for data in self.local_data if isinstance(data, Recording) and data.loaded_links), None)
        if loaded is not None:
            raise NotSupportedError(
                f"{estimator} fits the leg in the air, and something acts on {', '.join(loaded.loaded_links)}",
                where=loaded.source.name if loaded.source else "",
                remedy="use wls, huber, gls or ols",
            )

    @property
    def model(self) -> TorqueModel:
        """Torque model of the only group."""
        return self.single.model

    @property
    def local_data(self) -> Sequence[Recording | Poses]:
        """Recordings and poses of the only group."""
        return self.single.data

    @property
    def preparation(self) -> Preparation:
        """How the recordings of the only group become rows."""
        return self.single.preparation

    def prepared_by(self, preparation: Preparation) -> Problem:
        """Return the same problem with rows that are made in another way."""
        return replace(self, groups=tuple(replace(group, preparation=preparation) for group in self.groups))

    def with_data(self, data: Sequence[Recording | Poses]) -> Problem:
        """Return the same problem with other recordings of the only group."""
        return replace(self, groups=(replace(self.single, data=data),))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters."""
        return self.layout.names

    @property
    def joint_names(self) -> list[str]:
        """Joints of all groups, group by group."""
        return [name for group in self.groups for name in group.model.row_names]

    def solve(self, r_factor: RFactor, prior_knowledge: PriorKnowledge | None = None) -> Solution:
        """Solve for weighted rows, with what is known beside them."""
        knowledge = prior_knowledge or self.prior_knowledge
        return solve(r_factor, self.names, knowledge, self.nonnegative if knowledge.nonnegative else None)

    @cached_property
    def nonnegative(self) -> NDArray[np.bool_]:
        """Which parameters cannot be negative in nature, (P,)."""
        never = np.zeros(len(self.names), dtype=np.bool_)
        for places, rows in zip(self.layout.places, self.groups, strict=True):
            never[places] |= rows.model.nonnegative
        return never

    @cached_property
    def r_factors(self) -> list[RFactor]:
        """R factors of all groups, group by group, with a column for every parameter."""
        pairs = enumerate(self.groups)
        return [self.widened(r_factor, group) for group, rows in pairs for r_factor in rows.r_factors]

    @cached_property
    def columns(self) -> list[NDArray[np.intp]]:
        """Parameters that can act on each joint, as indices."""
        pairs = zip(self.layout.places, self.groups, strict=True)
        return [places[columns] for places, rows in pairs for columns in rows.columns]

    def weight_index(self, kind: NoiseKind, joint: int) -> int:
        """Place among :attr:`r_factors` of the one that holds the rows of a kind and joint."""
        group = int(np.searchsorted(self._joints, joint, side="right")) - 1
        return int(self._r_factors[group]) + self.groups[group].weight_index(kind, joint - int(self._joints[group]))

    def blocks(self, *, decimated: bool = False) -> Iterator[RowBlock]:
        """Go over the rows, group by group; columns are those of the group's own model."""
        for first, rows in zip(self._joints, self.groups, strict=False):
            for block in rows.blocks(decimated=decimated):
                yield block._replace(first=int(first))
            self._forget(rows)

    def gather(self, work: Callable[[Iterable[RowBlock]], T]) -> Iterator[T]:
        """Let work go over the decimated rows of each recording, group by group, and bring back what it finds."""
        for first, rows in zip(self._joints, self.groups, strict=False):
            yield from rows.gather(partial(_work_from, work, int(first)))
            self._forget(rows)

    def widened(self, r_factor: RFactor, group: int) -> RFactor:
        """Put the columns of an R factor of one group where its parameters stand."""
        if self.layout.identity:
            return r_factor
        count = len(self.names)
        return r_factor.among(np.append(self.layout.places[group], count), count + 1)

    def refuse_empty_joints(self) -> None:
        """Refuse a fit in which the terms' dead bands left no sample of a joint."""
        for name, rows in zip(self.layout.groups, self.groups, strict=True):
            with within(name):
                of_joints = zip(rows.model.row_names, *rows.by_kind, strict=True)
                driven = {name: stack(r_factors) for name, *r_factors in of_joints if name not in rows.unmeasured}
                if empty := tuple(name for name, r_factor in driven.items() if not r_factor.rows):
                    raise NotIdentifiableError(
                        f"no sample of {', '.join(empty)} is faster than the dead band of its friction term",
                        remedy="move faster, or choose a smaller dead_band",
                        joints=empty,
                    )
            self._forget(rows)

    def weights_of(self, group: int, weights: Sequence[float]) -> list[float]:
        """Weights of the R factors of one group."""
        return list(weights[self._r_factors[group] : self._r_factors[group + 1]])

    def joints_of(self, group: int) -> tuple[int, int]:
        """First joint of a group, and the one behind its last, among those of all groups."""
        return int(self._joints[group]), int(self._joints[group + 1])

    def rows_of(self, group: int, weights: Sequence[float]) -> RFactor:
        """Weighted rows of one group."""
        return self.widened(stack(self.groups[group].r_factors, self.weights_of(group, weights)), group)

    def recording_r_factors(self, weights: Sequence[float]) -> list[RFactor]:
        """R factor of the weighted rows of each recording, group by group."""
        return [
            self.widened(rows.recording_r_factor(index, self.weights_of(group, weights)), group)
            for group, rows in enumerate(self.groups)
            for index in range(len(rows.data))
        ]

    def without(self, index: int, others: RFactor, solution: Solution) -> FloatArray:
        """Solve without one of the recordings; a group that has no other loses its own parameters."""
        group = [g for g, rows in enumerate(self.groups) for _ in rows.each][index]
        if len(self.groups[group].data) > 1:
            return self.solve(others).values
        places = [self.layout.place(name, group) for name in self.layout.own]
        lost = [k for k in places if self.names[k] not in self.prior_knowledge.names]
        known = {**self.prior_knowledge.known, **{self.names[k]: float(solution.values[k]) for k in lost}}
        found = self.solve(others, replace(self.prior_knowledge, known=known)).values.copy()
        found[lost] = np.inf
        return found

    def _forget(self, rows: GroupRows) -> None:
        """Release the kinematics of a group's last recording where other groups need the memory."""
        if len(self.groups) > 1:
            rows.forget()

    @cached_property
    def _joints(self) -> NDArray[np.intp]:
        """First joint of each group, and how many there are in all."""
        return np.cumsum([0, *(len(rows.columns) for rows in self.groups)])

    @cached_property
    def _r_factors(self) -> NDArray[np.intp]:
        """First R factor of each group, and how many there are in all."""
        return np.cumsum([0, *(len(rows.r_factors) for rows in self.groups)])


def _work_from(work: Callable[[Iterable[RowBlock]], T], first: int, blocks: Iterable[RowBlock]) -> T:
    """Count joints from that one on."""
    return work(block._replace(first=first) for block in blocks)
