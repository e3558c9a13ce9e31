"""Source location: a row of an array or a line of a file, as errors name it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SourceLocation:
    """Names rows and columns of an array by their place in the file."""

    file: str = ""  # path of the file; empty for arrays made in memory
    # number of each row in the file, (N,); None if rows count from 0, as in arrays
    lines: NDArray[np.int64] | None = None
    # header in the file of each exoid column whose name differs
    headers: Mapping[str, str] = field(default_factory=dict)
    row_name: str = "line"  # word for a row of the file: "line", "row" or "message"

    def row(self, row: int) -> str:
        """Name a row: "row 17" (from 0) of an array, or "log.csv, line 19" of a file."""
        if self.lines is not None:
            return f"{self.file}, {self.row_name} {self.lines[row]}"
        return f"{self.file}, row {row}" if self.file else f"row {row}"

    def column(self, column: str) -> str:
        """Name a column by its header in the file, followed by exoid's name if that differs."""
        header = self.headers.get(column, column)
        return column if header == column else f"{header} ({column})"

    def cell(self, row: int, column: str) -> str:
        """Name one value."""
        return f"{self.row(row)}, column {self.column(column)}"
