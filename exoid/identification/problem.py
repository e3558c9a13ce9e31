"""What estimators work on: triangles that hold all rows, and the rows themselves, recording by recording."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import TorqueModel

from .rows import Rows, Triangle, join, make_rows, make_triangles, thin

KEPT_BYTES = 2**26
"""Rows are kept between passes as long as together they stay below this, and made again otherwise."""


class Kind(NamedTuple):
    """Rows whose torque noise is of one kind.

    Attributes:
        at_rest: Poses, whose noise is independent from one to the next.
        pace: Logarithm of the sampling interval, in steps of a tenth: recordings of one pace share a noise model.
    """

    at_rest: bool
    pace: int


class Block(NamedTuple):
    """Rows of one recording and the kind of their noise."""

    kind: Kind
    rows: Rows


@dataclass(frozen=True, eq=False)
class Problem:
    """τ = W β over recordings and poses.

    A first pass over the rows leaves triangles, which suffice for least squares; whoever needs more goes over
    :meth:`blocks`. Memory is that of the rows of one recording, and of small ones that are kept.

    Attributes:
        model: What is to be identified.
        data: Recordings and poses.
        preparation: How they become rows.
        keep: Which rows to use, given the index of the recording and their times [s], (N,); None for all.
    """

    model: TorqueModel
    data: Sequence[Recording | Poses]
    preparation: Preparation
    keep: Callable[[int, FloatArray], NDArray[np.bool_]] | None = None
    _kept: dict[tuple[int, bool], Rows] = field(default_factory=dict, init=False, repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return self.model.names

    @cached_property
    def groups(self) -> list[list[Triangle]]:
        """One triangle a joint over all recordings, and one over all poses, which have noise of their own."""
        each: dict[bool, list[list[Triangle]]] = {False: [], True: []}
        for block in self.blocks():
            each[block.kind.at_rest].append(make_triangles(block.rows))
        return [[join(of_joint) for of_joint in zip(*group, strict=True)] for group in each.values() if group]

    @property
    def triangles(self) -> list[Triangle]:
        """All triangles, joint by joint, those of recordings before those of poses."""
        return [triangle for group in self.groups for triangle in group]

    def weight_index(self, kind: Kind, joint: int) -> int:
        """Place among :attr:`triangles` of the one that holds the rows of a kind and joint."""
        return joint + (len(self.groups[0]) if kind.at_rest and len(self.groups) > 1 else 0)

    def blocks(self, *, thinned: bool = False) -> Iterator[Block]:
        """Go over the rows, recording by recording.

        Args:
            thinned: Only as many as carry independent noise, see :func:`exoid.identification.rows.thin`.
        """
        for index, data in enumerate(self.data):
            rows = self._kept.get((index, thinned)) or self._make(index, thinned)
            at_rest = isinstance(data, Poses)
            pace = 0 if at_rest or len(rows.time) < 2 else round(math.log(rows.time[1] - rows.time[0]) / math.log(1.1))
            yield Block(Kind(at_rest, pace), rows)

    def _make(self, index: int, thinned: bool) -> Rows:
        """Make rows, and keep them and what is left of them after thinning where there is room."""
        whole = self._kept.get((index, False)) or self._chosen(index)
        few = thin(whole)
        for key, rows in (((index, True), few), ((index, False), whole)):
            if key not in self._kept and sum(r.W.nbytes for r in self._kept.values()) + rows.W.nbytes <= KEPT_BYTES:
                self._kept[key] = rows
        return few if thinned else whole

    def _chosen(self, index: int) -> Rows:
        rows = make_rows(self.model, self.data[index], self.preparation)
        if self.keep is None:
            return rows
        return rows._replace(usable=rows.usable & self.keep(index, rows.time)[:, None])
