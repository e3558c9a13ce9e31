"""Files of one trial on one clock, read as one table: angles by inverse kinematics, torques by inverse dynamics."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError, in_file

from . import checks, timebase
from .column import Column
from .filters.low_pass import zero_phase
from .readers import Table
from .readers.formats import open_table
from .readers.text import SAID
from .source import Source, SourceLocation


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


def join(first: Table, paths: Sequence[str | os.PathLike[str]], stamps: Column) -> Table:
    """Join files of the same clock: columns of the first, and those of others at its stamps, while all of them last."""
    begins = _time_of(first, stamps)
    others: list[tuple[Table, FloatArray]] = []
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
    rows = slice(int(np.searchsorted(begins, start)), int(np.searchsorted(begins, stop, side="right")))
    shared, tables = begins[rows], (first, *(table for table, _ in others))

    def numbers(columns: Sequence[str]) -> FloatArray:
        """Read columns; those of other files are interpolated, behind a low-pass where they are sampled faster."""
        out = np.empty((len(shared), len(columns)))
        own = [k for k, name in enumerate(columns) if name in first.header]
        out[:, own] = first.numbers([columns[k] for k in own])[rows]
        left = [k for k in range(len(columns)) if k not in own]
        for table, time in others:
            here = [k for k in left if columns[k] in table.header]
            left = [k for k in left if k not in here]
            if here:
                names = [columns[k] for k in here]
                values = table.numbers(names)
                checks.refuse_not_finite(values, names, SourceLocation(table.lines, {}, table.row_name))
                out[:, here] = values_at(time, values, shared, smooth=True)
                for k, column in zip(here, values.T, strict=True):
                    if np.isin(column, (0.0, 1.0)).all():  # a switch or a mask
                        out[:, k] = timebase.interpolate_mask(time, column != 0.0, shared)
        return out

    def said(word: str) -> tuple[str, ...]:
        """Lines above the data of all files; those of the first are last, and count where others contradict them."""
        own = first.said.get(word, ())
        return (*(line for table, _ in others for line in table.said.get(word, ()) if line not in own), *own)

    listed = "".join(f"{table.source.sha256}  {table.source.name}\n" for table in tables)
    names = " + ".join(table.source.name for table in tables)
    home = {name: table for table in reversed(tables) for name in table.header}
    return replace(
        first,
        source=Source(names, hashlib.sha256(listed.encode()).hexdigest()),
        header=tuple(dict.fromkeys(name for table in tables for name in table.header)),
        numbers=numbers,
        length=len(shared),
        lines=None if first.lines is None else first.lines[rows],
        in_degrees=frozenset(name for name, table in home.items() if name in table.in_degrees),
        said={word: said(word) for word in SAID},
    )


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
