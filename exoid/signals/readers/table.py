"""Table of a log file: named columns of numbers, with the place of each row in the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import NotSupportedError, UnreadableInputError
from exoid.signals.source import Source
from exoid.tools.extras import install_extra
from exoid.tools.file_bounds import refuse_expansion

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
        in_degrees: Whether the file says that its angles are in degrees, as OpenSim's do.
        said: Texts of lines above the data, behind each beginning that is read.
    """

    file: str
    source: Source
    header: tuple[str, ...]
    numbers: Callable[[Sequence[str]], FloatArray]
    length: int
    lines: NDArray[np.int64] | None = None
    row_name: str = "row"
    in_degrees: bool = False
    said: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return self.length


class ArrayTable(Table):
    """A table whose columns are in memory; dates become seconds since the first one."""

    def __init__(
        self,
        file: str,
        source: Source,
        columns: Mapping[str, ArrayLike],
        lines: NDArray[np.int64] | None = None,
        row_name: str = "row",
    ) -> None:
        """Make the table.

        Args:
            file: See :class:`Table`.
            source: See :class:`Table`.
            columns: The columns by name, all of one length, (N,).
            lines: See :class:`Table`.
            row_name: See :class:`Table`.

        Raises:
            ExoidError: Columns are not of one length.
        """
        arrays = {name: np.asarray(values) for name, values in columns.items()}
        shapes = {values.shape for values in arrays.values()}
        if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
            found = ", ".join(f"{name} {values.shape}" for name, values in list(arrays.items())[:20])
            raise UnreadableInputError(
                f"columns are not of one length: {found}", remedy="give each one number a sample"
            )
        length = len(next(iter(arrays.values()), ()))

        def numbers(names: Sequence[str]) -> FloatArray:
            if Path(file).exists():
                refuse_expansion(8 * length * len(names), Path(file))
            return np.column_stack([as_column(arrays[name], name) for name in names])

        super().__init__(file, source, tuple(arrays), numbers, length, lines, row_name)


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
