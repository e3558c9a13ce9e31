"""Parquet files, read by polars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals.source import Source

from .table import ReadOptions, as_column, needs, reading, refuse_expansion

REMEDY = "check that the writer closed it; write it again"


@dataclass(frozen=True, eq=False)
class ParquetTable:
    """A Parquet file, of which only the requested columns are read; attributes as those of ``Table``.

    Attributes:
        length: Number of rows.
    """

    file: str
    source: Source
    header: tuple[str, ...]
    length: int
    lines: NDArray[np.int64] | None = None
    row_name: str = "row"

    def __len__(self) -> int:
        return self.length

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; empty cells become NaN.

        Args:
            columns: Names of k columns.

        Returns:
            Numbers, (N, k).

        Raises:
            ExoidError: A column does not hold numbers, or the file is damaged.
        """
        polars = _polars(self.file)
        refuse_expansion(8 * self.length * len(columns), Path(self.file), self.file)
        with reading(self.file, "Parquet", REMEDY):
            frame = polars.read_parquet(self.file, columns=list(columns), glob=False, hive_partitioning=False)
            arrays = [self._column(frame[name]) for name in columns]
        return np.column_stack(arrays)

    def _column(self, series: Any) -> FloatArray:  # noqa: ANN401 - a polars.Series
        where = f"{self.file}, column {series.name}"
        if series.dtype.is_decimal():
            series = series.cast(_polars(self.file).Float64)
        if not (series.dtype.is_numeric() or series.dtype.is_temporal()):
            raise ExoidError(f"holds {series.dtype}, not real numbers", where=where, remedy="write numbers in SI units")
        return as_column(series.to_numpy(), where)


def read_parquet(file: str, options: ReadOptions) -> ParquetTable:
    """Read the header of a Parquet file.

    Args:
        file: Path as the caller gave it.
        options: What the caller requests; columns are selected later.

    Returns:
        The table.

    Raises:
        ExoidError: polars is missing, or the file is damaged.
    """
    polars = _polars(file)
    with reading(file, "Parquet", REMEDY):
        names = tuple(polars.read_parquet_schema(file))
        rows = polars.scan_parquet(file, glob=False, hive_partitioning=False).select(polars.len()).collect().item()
        return ParquetTable(file, Source.of(Path(file)), names, int(rows))


def _polars(file: str) -> Any:  # noqa: ANN401 - a module
    try:
        import polars  # noqa: PLC0415 - an extra
    except ImportError:
        raise needs("polars", "Parquet", file) from None
    return polars
