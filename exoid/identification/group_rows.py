"""Group of recordings of one leg, and its rows: R factors that hold all of them, and the rows in order of time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import RFactor, factorize_rows, stack
from exoid.regression.row_data import NoiseKind, RowBlock, Rows, RowsFile
from exoid.regression.rows import Prepared, chain, decimate, decimation, form_rows, prepare, rate_class
from exoid.signals import Poses, Preparation, Recording, Recordings
from exoid.torques import TorqueModel

from .recording_summary import RecordingSummary

KEPT_BYTES = 2**26  # rows are kept between passes as long as together they stay below this, and made again otherwise,

Keep = Callable[[int, FloatArray], NDArray[np.bool_]]
"""Which rows to use: recording index, times [s] → mask."""

Data = Sequence[Recording | Poses]
"""Recordings and poses, in memory or on disk."""

Measured = Recording | Poses | Iterable[Recording | Poses]
"""One recording or several."""


def check_recordings(given: Measured) -> Data:
    """Check that there is at least one recording, and nothing else; those on disk stay there."""
    if isinstance(given, Recordings) and len(given):
        return given
    several = [given] if isinstance(given, (Recording, Poses, str, PathLike)) else list(given)
    wrong = [item for item in several if not isinstance(item, (Recording, Poses, Recordings))]
    if wrong or not several:
        what = f"{wrong[0]!r} is no recording" if wrong else "no recordings"
        raise BadArgumentError(what, remedy='pass at least one, such as Recording.from_csv("log.csv")')
    if any(isinstance(item, Recordings) for item in several):
        items = (item.items if isinstance(item, Recordings) else (item,) for item in several)
        return Recordings(tuple(each for of_item in items for each in of_item))
    return several


@dataclass(frozen=True, eq=False)
class Group:
    """Recordings of one leg, or of one session, and their rows τ = W β."""

    # A first pass over the rows leaves R factors, which suffice for least squares; whoever needs more goes over
    # `blocks`. A regressor is never formed for more than some ten thousand samples at once: memory is that of
    # the kinematics of one recording, and of rows that are kept where there are few.

    name: str  # name of the group; "" where there is only one
    model: TorqueModel  # torque model of its leg
    data: Data  # recordings and poses, in memory or on disk
    preparation: Preparation | None = None  # filter and differentiation; None while it is not chosen
    links: str | None = None  # links that rest by an unknown wrench; None where no row depends on contacts
    unmeasured: tuple[str, ...] = ()  # joints without torque in any of the recordings, which have no rows
    summaries: Sequence[RecordingSummary] = ()  # of the recordings; empty before they were read
    findings: tuple[Finding, ...] = ()  # what was mended in the logs
    delays: FloatArray | None = None  # delays that were taken out of the torques [s], (n,); None for none
    actuators: Actuators | None = None  # drives; None where torques were measured
    memory_share: float = 1.0  # part of `KEPT_BYTES` for rows that are kept, where there are several groups
    _kept: dict[tuple[int, bool], list[Rows]] = field(default_factory=dict, init=False, repr=False)
    _filed: dict[int, RowsFile] = field(default_factory=dict, init=False, repr=False)
    _prepared: dict[int, Prepared] = field(default_factory=dict, init=False, repr=False)

    @property
    def stands(self) -> bool:
        """Whether recordings have to be split by the links that rest on the ground."""
        return bool(self.model.leg.base_rows) or any(one.stands for one in self.summaries)

    @property
    def plain_model(self) -> TorqueModel:
        """Torque model of the leg, whatever rests on the ground."""
        model = self.model
        return TorqueModel(model.leg, model.terms, model.rigid, model.regrouped, model.separate)

    @cached_property
    def each(self) -> list[list[RFactor]]:
        """One R factor a joint for each recording."""
        return [_r_factors(self.blocks_of(index)) for index in range(len(self.data))]

    @cached_property
    def by_kind(self) -> list[list[RFactor]]:
        """One R factor a joint over all recordings, and one over all poses, which have noise of their own."""
        groups = ([t for k, t in enumerate(self.each) if self.at_rest(k) is still] for still in (False, True))
        return [[stack(of_joint) for of_joint in zip(*group, strict=True)] for group in groups if group]

    @property
    def r_factors(self) -> list[RFactor]:
        """All R factors, joint by joint, those of recordings before those of poses."""
        return [r_factor for of_kind in self.by_kind for r_factor in of_kind]

    def place(self, at_rest: bool, joint: int) -> int:
        """Place among :attr:`r_factors` of a joint in poses, or in motion."""
        return joint + (len(self.by_kind[0]) if at_rest and len(self.by_kind) > 1 else 0)

    def at_rest(self, index: int) -> bool:
        """Say whether one of the recordings is poses, without reading it."""
        return isinstance((self.data.items if isinstance(self.data, Recordings) else self.data)[index], Poses)

    def blocks(self, *, decimated: bool = False, first: int = 0) -> Iterator[RowBlock]:
        """Go over the rows, recording by recording, each in order of time; joints are counted from the first on."""
        for index in range(len(self.data)):
            yield from self.blocks_of(index, decimated=decimated, first=first)

    def blocks_of(self, index: int, *, decimated: bool = False, first: int = 0) -> Iterator[RowBlock]:
        """Go over the rows of one recording."""
        filed = self._filed.get(index) if decimated else None
        stretches = iter(filed or self._kept.get((index, decimated)) or self._make(index, decimated))
        rows, kind, begins = next(stretches, None), None, True
        while rows is not None:
            following = next(stretches, None)
            kind = kind or NoiseKind(self.at_rest(index), rate_class(rows.time))
            yield RowBlock(kind, rows, begins, following is None, first)
            rows, begins = following, False

    def _make(self, index: int, decimated: bool) -> Iterator[Rows]:
        """Make rows stretch by stretch, and keep them and what is left of them after decimation where there is room."""
        if index not in self._prepared:
            self._prepared.clear()
            assert self.preparation is not None
            self._prepared[index] = prepare(self.model, self.data[index], self.preparation)
        prepared = self._prepared[index]
        count, step = len(prepared.rows), decimation(prepared.independent_fraction)
        size = 8 * count * prepared.tau.shape[1] * len(self.model.names)
        room = self.memory_share * KEPT_BYTES - sum(rows.W.nbytes for kept in self._kept.values() for rows in kept)
        keep_few = size / step <= room
        keep_whole = size * (1.0 + 1.0 / step) <= room
        # unless decimation leaves no more than one of so many: these go to a temporary file
        file = RowsFile() if not keep_few and step >= 4 else None
        whole, few = [], []
        before = 0
        for stretch in prepared.stretches():
            rows = form_rows(self.model, prepared, stretch)
            fewer = decimate(rows, before, count)
            before += len(stretch)
            if len(fewer.time):
                if keep_few:
                    few.append(fewer)
                elif file is not None:
                    file.add(fewer)
            if keep_whole:
                whole.append(rows)
            if not decimated:
                yield rows
            elif len(fewer.time):
                yield fewer
        if keep_few:
            self._kept[index, True] = [chain(few)]
        if keep_whole:
            self._kept[index, False] = whole
        if file is not None:
            self._filed[index] = file
        if self.memory_share < 1.0:  # other groups need the memory of the kinematics
            self._prepared.clear()


def _r_factors(blocks: Iterable[RowBlock]) -> list[RFactor]:
    """Triangles of the rows of one recording, joint by joint."""
    found: list[RFactor] = []
    for block in blocks:
        new = factorize_rows(block.rows)
        found = [stack(pair) for pair in zip(found, new, strict=True)] if found else new
    return found
