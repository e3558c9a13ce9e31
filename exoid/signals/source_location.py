"""Source location: a row of an array or a line of a file, as errors name it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray


class Evidence(TypedDict):
    """Arguments of an error that say where it is."""

    where: str
    file: str
    column: str


@dataclass(frozen=True)
class SourceLocation:
    """Names rows and columns of an array by their place in the file."""

    file: str = ""  # path of the file; empty for arrays made in memory
    # number of each row in the file, (N,); None if rows count from 0, as in arrays
    lines: NDArray[np.int64] | None = None
    # header in the file of each exoid column whose name differs
    headers: Mapping[str, str] = field(default_factory=dict)
    row_name: str = "line"  # word for a row of the file: "line", "row" or "message"

    def evidence(self, row: int | None = None, column: str = "") -> Evidence:
        """Name a cell: "row 17" (from 0) of an array, or "log.csv, line 19, column pos1 (q_hip)" of a file."""
        numbered = row is not None and self.lines is not None
        place = f"{self.row_name} {self.lines[row]}" if numbered else f"row {row}"  # type: ignore[index]
        header = self.headers.get(column, column)
        named = f"column {header}" if header == column else f"column {header} ({column})"
        parts = (self.file, place if row is not None else "", named if column else "")
        return {"where": ", ".join(filter(None, parts)), "file": self.file, "column": column}
