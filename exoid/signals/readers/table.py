"""Table of a log file: named columns of numbers, with the place of each row in the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError, UnreadableInputError
from exoid.signals.source import Source
from exoid.tools.extras import install_extra
from exoid.tools.file_bounds import refuse_expansion

MOST_COLUMNS = 10_000
"""Largest number of columns of a log; humanoids have some hundreds."""


def refuse_columns(count: int) -> None:
    """Refuse a file with more columns than any log has."""
    if count > MOST_COLUMNS:
        raise UnreadableInputError(
            f"{count} columns, more than {MOST_COLUMNS}", remedy="write the columns of one leg's joints"
        )


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of a log file, not yet checked.

    Attributes:
        file: Path as the caller gave it, for messages.
        source: Name and SHA-256 of the file.
        header: Column names in the order of the file.
        numbers: Function that reads k columns by name, (N, k); NaN and infinity are allowed.
        length: Number of rows, N.
        lines: Number of each row in the file, (N,); None where rows count from 0.
        row_name: Word for a row: "line" of a text file, "row" or "message".
        in_degrees: Columns whose angles are in degrees, as the header of a file of OpenSim says of all.
        said: Texts of lines above the data, behind each beginning that is read.
    """

    file: str
    source: Source
    header: tuple[str, ...]
    numbers: Callable[[Sequence[str]], FloatArray]
    length: int
    lines: NDArray[np.int64] | None = None
    row_name: str = "row"
    in_degrees: frozenset[str] = frozenset()
    said: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return self.length


def array_table(
    file: str,
    columns: Mapping[str, NDArray[Any]],
    lines: NDArray[np.int64] | None = None,
    row_name: str = "row",
) -> Table:
    """Make a table of columns in memory, all of one length; dates become seconds since the first one."""
    length = len(next(iter(columns.values()), ()))

    def numbers(names: Sequence[str]) -> FloatArray:
        refuse_expansion(8 * length * len(names), Path(file))
        return np.column_stack([as_column(columns[name], name) for name in names])

    return Table(file, Source.of(Path(file)), tuple(columns), numbers, length, lines, row_name)


def as_column(values: NDArray[Any], name: str) -> FloatArray:
    """Convert an array of any real type, or of dates or durations, to float64; dates become seconds since the first."""
    if values.dtype.kind in "mM":
        ticks, missing = values.astype(f"{values.dtype.kind}8[ns]").astype(np.int64), np.isnat(values)
        first = ticks[0] if values.dtype.kind == "M" and len(ticks) else 0
        return np.where(missing, np.nan, (ticks - first) / 1e9)
    if values.dtype.kind not in "biuf" or values.ndim > 1:
        raise UnreadableInputError(
            f"holds {values.dtype}, not real numbers",
            where=f"column {name}",
            column=name,
            remedy="write numbers in SI units",
        )
    return np.asarray(values, dtype=np.float64)


def needs(package: str, kind: str) -> NotSupportedError:
    """Make the error about a package that is not installed."""
    return NotSupportedError(f"reading {kind} needs {package}", remedy=f"{install_extra('io')}, or convert to CSV")
