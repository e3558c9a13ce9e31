"""CSV writer."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.files import write_whole

ROWS_AT_ONCE = 4096


class LogPart(NamedTuple):
    """Columns of a log file, and the lines above the header that belong to them.

    Attributes:
        names: Names of the k columns.
        columns: Columns, (N,) or (N, j) each, k in all.
        comments: Lines, each with its ``#``.
    """

    names: Sequence[str]
    columns: Sequence[FloatArray]
    comments: Sequence[str] = ()


def write_csv(
    path: str | os.PathLike[str], header: Sequence[str], table: FloatArray, comments: Sequence[str] = ()
) -> None:
    """Write a header line and numbers, as the shortest decimals that read back exactly.

    Args:
        path: File to write; an existing one is replaced only when the new one is complete.
        header: Names of the k columns.
        table: Numbers, (N, k).
        comments: Lines above the header, each with its ``#``.

    Raises:
        ExoidError: The folder is missing or cannot be written, or the disk is full.
    """
    write_whole(path, _lines(header, table, comments))


def write_parts(path: str | os.PathLike[str], parts: Sequence[LogPart]) -> None:
    """Write columns side by side, and all lines above the header.

    Args:
        path: File to write; an existing one is replaced only when the new one is complete.
        parts: The columns.

    Raises:
        ExoidError: As for :func:`write_csv`.
    """
    header = [name for part in parts for name in part.names]
    comments = [line for part in parts for line in part.comments]
    write_csv(path, header, np.column_stack([column for part in parts for column in part.columns]), comments)


def _lines(header: Sequence[str], table: FloatArray, comments: Sequence[str]) -> Iterator[str]:
    yield from (f"{line}\n" for line in comments)
    yield ",".join(header) + "\n"
    for start in range(0, len(table), ROWS_AT_ONCE):
        rows = table[start : start + ROWS_AT_ONCE].tolist()
        yield "".join(",".join(map(repr, row)) + "\n" for row in rows)
