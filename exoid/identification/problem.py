"""What estimators work on: triangles that hold all rows, and the rows themselves, recording by recording."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from operator import attrgetter
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.regression.least_squares import Solution, solve
from exoid.regression.prior_knowledge import NOTHING, Assumed
from exoid.regression.r_factor import Triangle, join, make_triangles
from exoid.regression.rows import Prepared, Rows, chain, form_rows, prepare, thin, thinning
from exoid.regression.rows_file import RowsFile
from exoid.signals import Cluster, Poses, Preparation, Recording
from exoid.torques import TorqueModel

from .sources import at_rest

KEPT_BYTES = 2**26
"""Rows are kept between passes as long as together they stay below this, and made again otherwise,"""

WORTH_FILING = 4
"""unless thinning leaves no more than one of so many: these go to a temporary file."""

T = TypeVar("T")


class Kind(NamedTuple):
    """Rows whose torque noise is of one kind.

    Attributes:
        at_rest: Poses, whose noise is independent from one to the next.
        pace: Logarithm of the sampling interval, in steps of a tenth: recordings of one pace share a noise model.
    """

    at_rest: bool
    pace: int


class Block(NamedTuple):
    """Consecutive rows of one recording and the kind of their noise.

    Attributes:
        kind: Of the noise.
        rows: The rows.
        begins: Whether these are the first of the recording.
        ends: Whether these are the last of it.
        first: Index of the first joint of the rows among those of the problem.
    """

    kind: Kind
    rows: Rows
    begins: bool
    ends: bool
    first: int = 0


@dataclass(frozen=True, eq=False)
class Problem:
    """τ = W β over recordings and poses.

    A first pass over the rows leaves triangles, which suffice for least squares; whoever needs more goes over
    :meth:`blocks`. A regressor is never formed for more than some ten thousand samples at once: memory is that of
    the kinematics of one recording, and of rows that are kept where there are few.

    Attributes:
        model: What is to be identified.
        data: Recordings and poses, in memory, on disk, or on a cluster.
        preparation: How they become rows.
        assumed: What is known beside them.
        keep: Which rows to use, given the index of the recording and their times [s], (N,); None for all.
        room: Part of the memory for rows that are kept, where there are several problems.
    """

    model: TorqueModel
    data: Sequence[Recording | Poses] | Cluster
    preparation: Preparation
    keep: Callable[[int, FloatArray], NDArray[np.bool_]] | None = None
    assumed: Assumed = NOTHING
    room: float = 1.0
    _kept: dict[tuple[int, bool], list[Rows]] = field(default_factory=dict, init=False, repr=False)
    _filed: dict[int, RowsFile] = field(default_factory=dict, init=False, repr=False)
    _prepared: dict[int, Prepared] = field(default_factory=dict, init=False, repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return self.model.names

    def solve(self, triangle: Triangle) -> Solution:
        """Solve for weighted rows, with what is known beside them."""
        bounds = self.model.nonnegative if self.assumed.nonnegative else None
        return solve(triangle, self.names, self.assumed, bounds)

    @property
    def here(self) -> Sequence[Recording | Poses]:
        """Recordings and poses.

        Raises:
            ExoidError: They are on a cluster, which does not let them go.
        """
        if isinstance(self.data, Cluster):
            raise ExoidError(
                "recordings stay on the workers of the cluster, and this estimator wants them here",
                remedy="use wls or ols, or pass Recordings on disk",
            )
        return self.data

    @cached_property
    def each(self) -> list[list[Triangle]]:
        """One triangle a joint for each recording."""
        if isinstance(self.data, Cluster):
            return self._pieces.map(attrgetter("triangles"))
        return [_triangles(self._blocks_of(index, thinned=False)) for index in range(len(self.data))]

    @cached_property
    def groups(self) -> list[list[Triangle]]:
        """One triangle a joint over all recordings, and one over all poses, which have noise of their own."""
        groups = ([t for k, t in enumerate(self.each) if self.at_rest(k) is still] for still in (False, True))
        return [[join(of_joint) for of_joint in zip(*group, strict=True)] for group in groups if group]

    @property
    def triangles(self) -> list[Triangle]:
        """All triangles, joint by joint, those of recordings before those of poses."""
        return [triangle for group in self.groups for triangle in group]

    @cached_property
    def columns(self) -> list[NDArray[np.intp]]:
        """Parameters that can act on each joint, as indices."""
        return [np.flatnonzero(acting) for acting in self.model.acting]

    def weight_index(self, kind: Kind, joint: int) -> int:
        """Place among :attr:`triangles` of the one that holds the rows of a kind and joint."""
        return self.place(kind.at_rest, joint)

    def place(self, at_rest: bool, joint: int) -> int:
        """Place among :attr:`triangles` of a joint in poses, or in motion."""
        return joint + (len(self.groups[0]) if at_rest and len(self.groups) > 1 else 0)

    def at_rest(self, index: int) -> bool:
        """Say whether one of the recordings is poses."""
        return at_rest(self.data, index)

    def blocks(self, *, thinned: bool = False) -> Iterator[Block]:
        """Go over the rows, recording by recording, each in order of time.

        Args:
            thinned: Only as many as carry independent noise, see :func:`exoid.regression.rows.thin`.

        Raises:
            ExoidError: They are on a cluster, which does not let them go.
        """
        for index in range(len(self.here)):
            yield from self._blocks_of(index, thinned=thinned)

    def gather(self, work: Callable[[Iterable[Block]], T]) -> Iterator[T]:
        """Let work go over the thinned rows of each recording, wherever they are, and bring back what it finds."""
        if isinstance(self.data, Cluster):
            yield from self._pieces.map(partial(_on_blocks, work))
            return
        for index in range(len(self.data)):
            yield work(self._blocks_of(index, thinned=True))

    @cached_property
    def _pieces(self) -> Cluster:
        """Rows of each recording of a cluster, where they are."""
        assert isinstance(self.data, Cluster)
        return self.data.keep(partial(_make_piece, self.model, self.preparation))

    def _blocks_of(self, index: int, *, thinned: bool) -> Iterator[Block]:
        """Go over the rows of one recording."""
        filed = self._filed.get(index) if thinned else None
        stretches = filed or self._kept.get((index, thinned)) or self._make(index, thinned)
        kind = None
        for rows, begins, ends in _with_ends(stretches):
            kind = kind or Kind(self.at_rest(index), _pace(rows.time))
            yield Block(kind, rows, begins, ends)

    def forget(self) -> None:
        """Let go of the recording that was prepared last; rows that are kept stay."""
        self._prepared.clear()

    def _make(self, index: int, thinned: bool) -> Iterator[Rows]:
        """Make rows stretch by stretch, and keep them and what is left of them after thinning where there is room."""
        prepared = self._prepare(index)
        count, step = len(prepared.rows), thinning(prepared.independence)
        size = 8 * count * prepared.tau.shape[1] * len(self.names)
        room = self.room * KEPT_BYTES - sum(rows.W.nbytes for kept in self._kept.values() for rows in kept)
        keep_few = size / step <= room
        keep_whole = size * (1.0 + 1.0 / step) <= room
        file = RowsFile() if not keep_few and step >= WORTH_FILING else None
        whole, few = [], []
        before = 0
        for stretch in prepared.stretches():
            rows = form_rows(self.model, prepared, stretch)
            fewer = thin(rows, before, count)
            before += len(stretch)
            if len(fewer.time):
                if keep_few:
                    few.append(fewer)
                elif file is not None:
                    file.add(fewer)
            if keep_whole:
                whole.append(rows)
            if not thinned:
                yield rows
            elif len(fewer.time):
                yield fewer
        if keep_few:
            self._kept[index, True] = [chain(few)]
        if keep_whole:
            self._kept[index, False] = whole
        if file is not None:
            self._filed[index] = file

    def _prepare(self, index: int) -> Prepared:
        """Prepare a recording, and remember the last one."""
        if index not in self._prepared:
            self._prepared.clear()
            prepared = prepare(self.model, self.here[index], self.preparation)
            if self.keep is not None:
                prepared = prepared._replace(usable=prepared.usable & self.keep(index, prepared.time)[:, None])
            self._prepared[index] = prepared
        return self._prepared[index]


class Piece(NamedTuple):
    """What is made of one recording on a worker, and stays there.

    Attributes:
        triangles: One a joint.
        blocks: Thinned rows.
    """

    triangles: list[Triangle]
    blocks: tuple[Block, ...]


def _make_piece(model: TorqueModel, preparation: Preparation, data: Recording) -> Piece:
    """Make the rows of one recording."""
    alone = Problem(model, [data], preparation)
    # not alone.each: before Python 3.12 a cached property waits for that of any other object, which waits for this one
    return Piece(_triangles(alone.blocks()), tuple(alone.blocks(thinned=True)))


def _on_blocks(work: Callable[[Iterable[Block]], T], piece: Piece) -> T:
    return work(piece.blocks)


def _triangles(blocks: Iterable[Block]) -> list[Triangle]:
    """Triangles of the rows of one recording, joint by joint."""
    found: list[Triangle] = []
    for block in blocks:
        new = make_triangles(block.rows)
        found = [join(pair) for pair in zip(found, new, strict=True)] if found else new
    return found


def _pace(time: FloatArray) -> int:
    """Logarithm of the sampling interval to base 1.1, rounded."""
    return 0 if len(time) < 2 else round(math.log(time[1] - time[0]) / math.log(1.1))


def _with_ends(stretches: Iterable[Rows]) -> Iterator[tuple[Rows, bool, bool]]:
    """Say of each stretch whether it is the first, and whether it is the last."""
    begins, before = True, None
    for rows in stretches:
        if before is not None:
            yield before, begins, False
            begins = False
        before = rows
    if before is not None:
        yield before, begins, True
