"""Rows that wait in a temporary file for the next pass over them."""

from __future__ import annotations

import os
import pickle
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from exoid.errors import ExoidError

from .row_data import Rows


class RowsFile:
    """Stretches of one recording's rows, written once and read in order as often as wanted; gone with the object."""

    def __init__(self) -> None:
        """Open a file that has no name."""
        with _writing():
            self._file = tempfile.TemporaryFile(prefix="exoid-")  # noqa: SIM115 - closed with the last reference
        self._count = 0

    def add(self, rows: Rows) -> None:
        """Write one stretch more."""
        with _writing():
            pickle.dump(rows, self._file, protocol=pickle.HIGHEST_PROTOCOL)
            self._file.flush()
        self._count += 1

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[Rows]:
        """Read one stretch after the other."""
        place = 0
        for _ in range(self._count):
            self._file.seek(place)  # somebody else may be reading, too
            rows: Rows = pickle.load(self._file)
            place = self._file.tell()
            yield rows


@contextmanager
def _writing() -> Iterator[None]:
    """Turn an error of the operating system into one line about the folder of temporary files."""
    try:
        yield
    except OSError as problem:
        raise ExoidError(
            f"temporary rows cannot be written: {problem.strerror or problem}",
            where=os.environ.get("TMPDIR", ""),
            remedy="free space there, or name another folder by the environment variable TMPDIR",
        ) from None
