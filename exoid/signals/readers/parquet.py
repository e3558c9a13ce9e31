"""Parquet files, read by polars in a child process."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.signals.source import Source
from exoid.tools.file_bounds import reading, refuse_expansion
from exoid.tools.reader_process import read_in_child

from .options import ReadRequest
from .table import Table, as_column, needs, refuse_columns

REMEDY = "check that the writer closed it; write it again"


def read_parquet(file: str, request: ReadRequest) -> Table:
    """Read the header of a Parquet file, of which only the requested columns are read; empty cells become NaN."""
    if find_spec("polars") is None:
        raise needs("polars", "Parquet")
    with reading("Parquet", REMEDY):
        names, length = read_in_child(parquet_header, file)
        source = Source.of(Path(file))

    def numbers(columns: Sequence[str]) -> FloatArray:
        with reading("Parquet", REMEDY):
            refuse_expansion(8 * length * len(columns), Path(file))
            table = read_in_child(parquet_columns, file, names=list(columns))
        if len(table) != length:
            raise UnreadableInputError(f"{len(table)} rows, but {length} before", remedy="read it again")
        return table

    return Table(file, source, tuple(names), numbers, length)


def parquet_header(file: str) -> tuple[list[str], int]:
    """Read names of the columns and number of rows in this process, which polars may end."""
    import polars  # noqa: PLC0415 - an extra

    with reading("Parquet", REMEDY):
        names = list(polars.read_parquet_schema(file))
        refuse_columns(len(names))
        rows = polars.scan_parquet(file, glob=False, hive_partitioning=False).select(polars.len()).collect().item()
        return names, int(rows)


def parquet_columns(file: str, names: Sequence[str]) -> FloatArray:
    """Read columns in this process, which polars may end."""
    import polars  # noqa: PLC0415 - an extra

    with reading("Parquet", REMEDY):
        frame = polars.read_parquet(file, columns=list(names), glob=False, hive_partitioning=False)
        return np.column_stack([_column(frame[name], name) for name in names])


def _column(series: Any, name: str) -> FloatArray:  # noqa: ANN401 - a polars.Series
    import polars  # noqa: PLC0415 - an extra

    if series.dtype.is_decimal() or series.dtype == polars.Boolean:
        series = series.cast(polars.Float64)
    return as_column(series.to_numpy(), name)
