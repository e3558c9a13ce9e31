"""CSV writer."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.tools.files import write_whole


class LogPart(NamedTuple):
    """Columns of a log file, and the lines above the header that belong to them."""

    names: Sequence[str]  # names of the k columns
    columns: Sequence[FloatArray]  # columns, (N,) or (N, j) each, k in all
    comments: Sequence[str] = ()  # lines, each with its `#`


def write_csv(
    path: str | os.PathLike[str], header: Sequence[str], table: FloatArray, comments: Sequence[str] = ()
) -> None:
    """Write a header line and numbers, as the shortest decimals that read back exactly."""
    write_whole(path, _lines(header, table, comments))


def write_parts(path: str | os.PathLike[str], parts: Sequence[LogPart]) -> None:
    """Write columns side by side, and all lines above the header."""
    header = [name for part in parts for name in part.names]
    comments = [line for part in parts for line in part.comments]
    write_csv(path, header, np.column_stack([column for part in parts for column in part.columns]), comments)


def _lines(header: Sequence[str], table: FloatArray, comments: Sequence[str]) -> Iterator[str]:
    yield from (f"{line}\n" for line in comments)
    yield ",".join(header) + "\n"
    for start in range(0, len(table), 4096):
        rows = table[start : start + 4096].tolist()
        yield "".join(",".join(map(repr, row)) + "\n" for row in rows)
