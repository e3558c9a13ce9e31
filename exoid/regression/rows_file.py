"""Rows that wait in a temporary file for the next pass over them."""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Iterator

from .rows import Rows


class RowsFile:
    """Stretches of one recording's rows, written once and read in order as often as wanted; gone with the object."""

    def __init__(self) -> None:
        """Open a file that has no name."""
        self._file = tempfile.TemporaryFile(prefix="exoid-")  # noqa: SIM115 - closed with the last reference
        self._count = 0

    def add(self, rows: Rows) -> None:
        """Write one stretch more."""
        pickle.dump(rows, self._file, protocol=pickle.HIGHEST_PROTOCOL)
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
