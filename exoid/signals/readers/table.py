"""Table of a log file: named columns of numbers, with the place of each row in the file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError, UnreadableInputError
from exoid.signals.source import Source
from exoid.tools.extras import install_extra
from exoid.tools.reader_process.bounds import refuse_expansion

MOST_COLUMNS = 10_000
"""Largest number of columns of a log; humanoids have some hundreds."""

MOST_BLANK_LINES = 1_000_000
"""Largest number of blank lines and comments beyond one for each line with data."""


def refuse_columns(count: int) -> None:
    """Refuse a file with more columns than any log has."""
    if count > MOST_COLUMNS:
        raise UnreadableInputError(
            f"{count} columns, more than {MOST_COLUMNS}", remedy="write the columns of one leg's joints"
        )


@runtime_checkable
class Table(Protocol):
    """Columns of a log file, not yet checked."""

    @property
    def file(self) -> str:
        """Path as the caller gave it, for messages."""
        ...

    @property
    def source(self) -> Source:
        """Name and SHA-256 of the file."""
        ...

    @property
    def header(self) -> tuple[str, ...]:
        """Column names in the order of the file."""
        ...

    @property
    def lines(self) -> NDArray[np.int64] | None:
        """Number of each row in the file, (N,); None where rows count from 0."""
        ...

    @property
    def row_name(self) -> str:
        """Word for a row: "line", "row" or "message"."""
        ...

    def __len__(self) -> int: ...

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; NaN and infinity are allowed.

        Args:
            columns: Names of k columns.

        Returns:
            Numbers, (N, k).

        Raises:
            ExoidError: A column does not hold numbers.
        """
        ...


@dataclass(frozen=True, eq=False)
class ArrayTable:
    """A table whose columns are in memory; attributes as those of :class:`Table`.

    Attributes:
        columns: The columns by name, all of one length, (N,).

    Raises:
        ExoidError: Columns are not of one length.
    """

    file: str
    source: Source
    columns: Mapping[str, NDArray[Any]]
    lines: NDArray[np.int64] | None = None
    row_name: str = "row"

    def __post_init__(self) -> None:
        columns = {name: np.asarray(values) for name, values in self.columns.items()}
        shapes = {values.shape for values in columns.values()}
        if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
            found = ", ".join(f"{name} {values.shape}" for name, values in list(columns.items())[:20])
            raise UnreadableInputError(
                f"columns are not of one length: {found}", remedy="give each one number a sample"
            )
        object.__setattr__(self, "columns", columns)

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self.columns)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; dates become seconds since the first one."""
        if Path(self.file).exists():
            refuse_expansion(8 * len(self) * len(columns), Path(self.file))
        return np.column_stack([as_column(self.columns[name], name) for name in columns])


def as_column(values: NDArray[Any], name: str) -> FloatArray:
    """Convert an array of any real type, or of dates or durations, to float64; dates become seconds since the first."""
    if values.dtype.kind in "mM":
        ticks, missing = values.astype(f"{values.dtype.kind}8[ns]").astype(np.int64), np.isnat(values)
        first = ticks[0] if values.dtype.kind == "M" and len(ticks) else 0
        return np.where(missing, np.nan, (ticks - first) / 1e9)
    if values.dtype.kind not in "biuf":
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
