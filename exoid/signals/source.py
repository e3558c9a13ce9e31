"""Source of data: file name and hash, and the place of a row or line as errors name it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Source:
    """File that data were read from.

    Attributes:
        name: Name of the file, without its folder.
        sha256: SHA-256 of the bytes that were read, as 64 hexadecimal digits. For a folder (rosbag2) it is the hash of
            the list that ``sha256sum *`` prints there.
    """

    name: str
    sha256: str

    def __post_init__(self) -> None:
        """Make the name text: bytes that are not UTF-8 are written as backslash, x and two digits."""
        name = os.fsencode(self.name).decode("utf-8", "backslashreplace")
        object.__setattr__(self, "name", name)

    @staticmethod
    def of(path: Path) -> Source:
        """Hash a file, or a folder of files, without holding it in memory.

        Args:
            path: The file or folder.

        Returns:
            Its name and hash.

        Raises:
            OSError: It cannot be read.
        """
        name = path.name or path.resolve().name
        if not path.is_dir():
            return Source(name, _digest(path))
        files = sorted((file for file in path.iterdir() if file.is_file()), key=lambda file: file.name)
        listed = "".join(f"{_digest(file)}  {file.name}\n" for file in files)
        return Source(name, hashlib.sha256(listed.encode(errors="surrogateescape")).hexdigest())


def _digest(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(2**20):
            digest.update(chunk)
    return digest.hexdigest()


class Evidence(TypedDict):
    """Arguments of an error that say where it is."""

    where: str
    column: str


@dataclass(frozen=True)
class SourceLocation:
    """Names rows and columns of an array by their place in the file."""

    # number of each row in the file, (N,); None if rows count from 0, as in arrays
    lines: NDArray[np.int64] | None = None
    # header in the file of each exoid column whose name differs
    headers: Mapping[str, str] = field(default_factory=dict)
    row_name: str = "line"  # word for a row of the file: "line", "row" or "message"

    def evidence(self, row: int | None = None, column: str = "") -> Evidence:
        """Name a cell: "row 17" (from 0) of an array, or "line 19, column pos1 (q_hip)" of a file."""
        numbered = row is not None and self.lines is not None
        place = f"{self.row_name} {self.lines[row]}" if numbered else f"row {row}"  # type: ignore[index]
        header = self.headers.get(column, column)
        named = f"column {header}" if header == column else f"column {header} ({column})"
        parts = (place if row is not None else "", named if column else "")
        return {"where": ", ".join(filter(None, parts)), "column": column}


ARRAY = SourceLocation()
"""Rows of arrays in memory, which count from 0."""
