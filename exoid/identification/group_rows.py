"""Group of recordings of one leg, and its rows: R factors that hold all of them, and the rows in order of time."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import RFactor, factorize_rows, stack
from exoid.regression.row_data import Rows, RowsFile
from exoid.regression.rows import (
    Prepared,
    chain,
    decimate,
    decimation,
    form_rows,
    other_torque,
    prepare,
    with_torque,
)
from exoid.signals import Poses, Preparation, Recording, Recordings
from exoid.torques import TorqueModel

from .recording_summary import RecordingSummary

KEPT_BYTES = 2**26  # memory for rows that are kept between passes; others are made again

Data = Sequence[Recording | Poses]
"""Recordings and poses, in memory or on disk."""

Measured = Recording | Poses | Iterable[Recording | Poses]
"""One recording or several."""


def check_recordings(given: Measured) -> Data:
    """Check that there is at least one recording, and nothing else; those on disk stay there."""
    if isinstance(given, Recordings) and len(given):
        return given
    several = list(given) if isinstance(given, Iterable) and not isinstance(given, str) else [given]
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
    # `rows_of` or `decimated`. A regressor is never formed for more than some ten thousand samples at once: memory is
    # that of the kinematics and decimated rows of one recording, and of rows that are kept where there are few.

    name: str  # name of the group; "" where there is only one
    model: TorqueModel  # torque model of its leg
    data: Data  # recordings and poses, in memory or on disk
    preparation: Preparation | None = None  # filter and differentiation; None while it is not chosen
    links: str | None = None  # links that rest by an unknown wrench; None where no row depends on contacts
    summaries: Sequence[RecordingSummary] = ()  # of the recordings; empty before they were read
    findings: tuple[Finding, ...] = ()  # what was mended in the logs
    delays: FloatArray | None = None  # delays that were taken out of the torques [s], (n,); None for none
    actuators: Actuators | None = None  # drives; None where torques were measured
    # group of the same motion whose rows serve for this one, too, and the data that differ from it in torque alone
    like: tuple[Group, Data] | None = None
    memory_share: float = 1.0  # part of `KEPT_BYTES` for rows that are kept, where there are several groups
    _whole: dict[int, list[Rows]] = field(default_factory=dict, init=False, repr=False)
    _few: dict[int, Rows | RowsFile] = field(default_factory=dict, init=False, repr=False)  # after decimation
    _latest: dict[int, Rows] = field(default_factory=dict, init=False, repr=False)  # decimated rows of one recording
    _prepared: dict[int, Prepared] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def r_factors(self) -> list[RFactor]:
        """One R factor a joint over all recordings, then one over all poses, which have noise of their own."""
        found: dict[bool, list[list[RFactor]]] = {False: [], True: []}
        for index in range(len(self.data)):
            parts = [factorize_rows(rows) for rows in self.rows_of(index)]
            joined = [stack(of_joint) for of_joint in zip(*parts, strict=True)] if len(parts) > 1 else parts[0]
            found[self.at_rest(index)].append(joined)
        return [stack(of_joint) for of_kind in found.values() for of_joint in zip(*of_kind, strict=True)]

    @property
    def by_row(self) -> list[list[RFactor]]:
        """R factors of each row of the equation: in motion and at rest."""
        count = len(self.model.row_names)
        return [self.r_factors[row::count] for row in range(count)]

    @property
    def motions(self) -> list[Recording]:
        """Recordings among the data: of a leg that stands these are all."""
        return [one for one in self.data if isinstance(one, Recording)]

    def at_rest(self, index: int) -> bool:
        """Say whether one of the recordings is poses, without reading it."""
        return isinstance((self.data.items if isinstance(self.data, Recordings) else self.data)[index], Poses)

    def rows_of(self, index: int) -> Iterator[Rows]:
        """Go over all rows of one recording in order of time."""
        return iter(self._whole[index]) if index in self._whole else (rows for rows, _ in self._make(index))

    def decimated(self, index: int) -> Rows:
        """Rows of one recording that carry independent noise."""
        few = self._few.get(index) or self._latest.get(index)
        if few is None:  # several passes follow one another: the noise, the sandwich, the jackknife
            self._latest.clear()
            few = chain([fewer for _, fewer in self._make(index) if len(fewer.time)])
            if self.memory_share == 1.0:
                self._latest[index] = few
        return few.read() if isinstance(few, RowsFile) else few

    def _make(self, index: int) -> Iterator[tuple[Rows, Rows]]:
        """Make rows stretch by stretch, and what is left of them after decimation; keep both where there is room."""
        prepared, alike = self._motion(index)
        count = len(prepared.rows)
        step = decimation(prepared.independent_fraction, count).step
        size = 8 * count * prepared.tau.shape[1] * len(self.model.names)
        kept = [*itertools.chain(*self._whole.values()), *(few for few in self._few.values() if isinstance(few, Rows))]
        room = self.memory_share * KEPT_BYTES - sum(rows.W.nbytes for rows in kept)
        keep_whole, keep_few = size * (1.0 + 1.0 / step) <= room, size / step <= room
        file_few = not keep_few and step >= 4  # then reading them is faster than making them again
        whole, few, before = list[Rows](), list[Rows](), 0
        for stretch in prepared.stretches():
            same = next(alike, None)
            rows = form_rows(self.model, prepared, stretch) if same is None else with_torque(same, prepared, stretch)
            fewer = decimate(rows, before, count)
            before += len(stretch)
            whole += [rows] if keep_whole else []
            few += [fewer] if len(fewer.time) and (keep_few or file_few) else []
            yield rows, fewer
        if keep_whole:
            self._whole[index] = whole
        if keep_few:
            self._few[index] = chain(few)
        if file_few:
            self._few[index] = RowsFile(chain(few))
        if self.memory_share < 1.0:  # other groups need the memory of the kinematics
            self._prepared.clear()
            if self.like and not keep_whole:
                self.like[0]._prepared.clear()

    def _motion(self, index: int) -> tuple[Prepared, Iterator[Rows]]:
        """Make a recording ready; or find rows of the same motion, and what its torque has more."""
        assert self.preparation is not None
        like, changed = self.like or (self, ())
        if changed is self.data and like.model is self.model and like.preparation is self.preparation:
            one, before = self.data[index], like.data[index]
            if not isinstance(one, Poses) and np.array_equal(one.measured, getattr(before, "measured", [])):
                return other_torque(self.model, like._ready(index), one, self.preparation), like.rows_of(index)
        return self._ready(index), iter(())

    def _ready(self, index: int) -> Prepared:
        """Make a recording ready; the newest stays."""
        if index not in self._prepared:
            self._prepared.clear()
            assert self.preparation is not None
            self._prepared[index] = prepare(self.model, self.data[index], self.preparation)
        return self._prepared[index]
