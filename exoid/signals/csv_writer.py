"""CSV writer."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

from exoid._typing import FloatArray
from exoid.files import write_whole

ROWS_AT_ONCE = 4096


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


def _lines(header: Sequence[str], table: FloatArray, comments: Sequence[str]) -> Iterator[str]:
    yield from (f"{line}\n" for line in comments)
    yield ",".join(header) + "\n"
    for start in range(0, len(table), ROWS_AT_ONCE):
        rows = table[start : start + ROWS_AT_ONCE].tolist()
        yield "".join(",".join(map(repr, row)) + "\n" for row in rows)
