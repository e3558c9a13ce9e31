"""Parquet files, read by polars in a child process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.signals.source import Source
from exoid.tools.reader_process.bounds import reading, refuse_expansion
from exoid.tools.reader_process.child import Content, read_in_child

from .options import ReadRequest
from .table import as_column, needs, refuse_columns

REMEDY = "check that the writer closed it; write it again"


@dataclass(frozen=True, eq=False)
class ParquetTable:
    """A Parquet file, of which only the requested columns are read; attributes as those of ``Table``."""

    file: str
    source: Source
    header: tuple[str, ...]
    length: int  # number of rows
    lines: NDArray[np.int64] | None = None
    row_name: str = "row"

    def __len__(self) -> int:
        return self.length

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; empty cells become NaN."""
        with reading("Parquet", REMEDY):
            refuse_expansion(8 * self.length * len(columns), Path(self.file))
            arrays = read_in_child(parquet_columns, self.file, names=list(columns)).arrays
            table = np.column_stack([arrays[name] for name in columns])
        if len(table) != self.length:
            raise UnreadableInputError(f"{len(table)} rows, but {self.length} before", remedy="read it again")
        return table


def read_parquet(file: str, request: ReadRequest) -> ParquetTable:
    """Read the header of a Parquet file."""
    if find_spec("polars") is None:
        raise needs("polars", "Parquet")
    with reading("Parquet", REMEDY):
        facts = read_in_child(parquet_header, file).facts
        return ParquetTable(file, Source.of(Path(file)), tuple(facts["names"]), int(facts["rows"]))


def parquet_header(file: str) -> Content:
    """Read the header in this process, which polars may end."""
    import polars  # noqa: PLC0415 - an extra

    with reading("Parquet", REMEDY):
        names = list(polars.read_parquet_schema(file))
        refuse_columns(len(names))
        rows = polars.scan_parquet(file, glob=False, hive_partitioning=False).select(polars.len()).collect().item()
        return Content({}, {"names": names, "rows": int(rows)})


def parquet_columns(file: str, names: Sequence[str]) -> Content:
    """Read columns in this process, which polars may end."""
    import polars  # noqa: PLC0415 - an extra

    with reading("Parquet", REMEDY):
        frame = polars.read_parquet(file, columns=list(names), glob=False, hive_partitioning=False)
        return Content({name: _column(frame[name], name) for name in names})


def _column(series: Any, name: str) -> FloatArray:  # noqa: ANN401 - a polars.Series
    import polars  # noqa: PLC0415 - an extra

    if series.dtype.is_decimal() or series.dtype == polars.Boolean:
        series = series.cast(polars.Float64)
    if not (series.dtype.is_numeric() or series.dtype.is_temporal()):
        raise UnreadableInputError(
            f"holds {series.dtype}, not real numbers",
            where=f"column {name}",
            column=name,
            remedy="write numbers in SI units",
        )
    return as_column(series.to_numpy(), name)
