"""Files of one trial on one clock, read as one table: angles by inverse kinematics, torques by inverse dynamics."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError, in_file

from . import checks, timebase
from .column import Column
from .filters.low_pass import zero_phase
from .readers import Table
from .readers.formats import open_table
from .source import Source, SourceLocation


@dataclass(frozen=True, eq=False)
class JoinedTable:
    """Columns of the first file, and those of others at its time stamps, while all of them last."""

    first: Table
    others: Sequence[tuple[Table, FloatArray]]  # with their time stamps
    time: FloatArray  # time stamps of the rows that all files have [s]
    rows: slice  # these rows in the first file

    @property
    def file(self) -> str:
        """Path of the first file."""
        return self.first.file

    @property
    def source(self) -> Source:
        """Names of all files, and the hash of the list of their hashes."""
        sources = [self.first.source, *(table.source for table, _ in self.others)]
        digest = hashlib.sha256("".join(f"{each.sha256}  {each.name}\n" for each in sources).encode()).hexdigest()
        return Source(" + ".join(each.name for each in sources), digest)

    @property
    def header(self) -> tuple[str, ...]:
        """Columns of the first file, then those that only the others have."""
        tables = (self.first, *(table for table, _ in self.others))
        return tuple(dict.fromkeys(name for table in tables for name in table.header))

    @property
    def lines(self) -> NDArray[np.int64] | None:
        """Places of the rows in the first file."""
        return None if self.first.lines is None else self.first.lines[self.rows]

    @property
    def row_name(self) -> str:
        """Word of the first file."""
        return self.first.row_name

    @property
    def in_degrees(self) -> bool:
        """Whether the first file has its angles in degrees."""
        return bool(getattr(self.first, "in_degrees", False))

    def __len__(self) -> int:
        return len(self.time)

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; those of other files are interpolated, behind a low-pass where they are sampled faster."""
        out = np.empty((len(self), len(columns)))
        own = [k for k, name in enumerate(columns) if name in self.first.header]
        out[:, own] = self.first.numbers([columns[k] for k in own])[self.rows]
        left = [k for k in range(len(columns)) if k not in own]
        for table, time in self.others:
            here = [k for k in left if columns[k] in table.header]
            left = [k for k in left if k not in here]
            if here:
                names = [columns[k] for k in here]
                values = table.numbers(names)
                checks.refuse_not_finite(values, names, SourceLocation(table.lines, {}, table.row_name))
                out[:, here] = values_at(time, values, self.time, smooth=True)
        return out


def values_at(time: FloatArray, values: FloatArray, wanted: FloatArray, *, smooth: bool) -> FloatArray:
    """Values at other time stamps, behind a low-pass at 0.4 of their rate if that is lower."""
    if np.array_equal(time, wanted):
        return values
    rate, slower = timebase.sampling_rate(time), timebase.sampling_rate(wanted)
    if slower < 0.9 * rate:  # what is faster than half the lower rate would alias
        even = timebase.even_grid(time, rate)
        values, time = zero_phase(timebase.interpolate(time, values, even, smooth=smooth), rate, 0.4 * slower), even
    return timebase.interpolate(time, values, np.clip(wanted, time[0], time[-1]), smooth=smooth)


def in_order(numbers: FloatArray, names: Sequence[str], table: Table, *, split: bool = False) -> FloatArray:
    """Refuse missing numbers, and disordered time stamps in the first column; rows fill gaps of a log that is split."""
    where = SourceLocation(table.lines, {}, table.row_name)
    checks.refuse_too_few(len(numbers), where)
    checks.refuse_not_finite(numbers, names, where)
    if split:
        numbers, where = numbers[np.append(True, np.diff(numbers[:, 0]) != 0.0)], SourceLocation()
    checks.refuse_time_disorder(numbers[:, 0], where)
    if split:
        return timebase.split_at_gaps(numbers)[0]
    timebase.refuse_gaps(numbers[:, 0], where)
    return numbers


def join(first: Table, paths: Sequence[str | os.PathLike[str]], stamps: Column) -> JoinedTable:
    """Join files of the same clock to the first one."""
    begins, others = _time_of(first, stamps), []
    start, stop = begins[0], begins[-1]
    half = 0.5 * float(np.median(np.diff(begins)))
    for path in paths:
        with in_file(os.fsdecode(path)):
            table = open_table(path)
            time = _time_of(table, stamps)
            if time[0] > begins[-1] or time[-1] < begins[0]:
                raise UnreadableInputError(
                    f"from {time[0]:g} s to {time[-1]:g} s, while {first.source.name} is from {begins[0]:g} s to "
                    f"{begins[-1]:g} s",
                    remedy="give files of one trial, with time stamps of one clock",
                )
            others.append((table, time))
        start, stop = max(start, time[0] - half), min(stop, time[-1] + half)
    low, high = np.searchsorted(begins, start), np.searchsorted(begins, stop, side="right")
    return JoinedTable(first, others, begins[low:high], slice(int(low), int(high)))


def _time_of(table: Table, stamps: Column) -> FloatArray:
    """Time stamps of a file, checked."""
    name = stamps.header
    if name not in table.header:
        raise UnreadableInputError(
            f"no column {name!r} (no time stamps); the file has: {', '.join(table.header[:20])}",
            remedy="name it as in the first file",
            column="time",
        )
    return in_order(stamps.read("time", table.numbers([name])), (name,), table)[:, 0]
