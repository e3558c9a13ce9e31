"""How an error names a place in data: a row of an array, or a line of a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SourceLocation:
    """Translates row and column of an array into words that its owner can look up.

    Attributes:
        file: Path of the file the rows came from; empty for arrays made in memory.
        lines: (N,) number of each row in that file; None where rows count from 0, as in arrays.
        headers: The file's own header of a column, where it is not called as exoid calls it.
        counted: What a row of the file is called: "line", "row" or "message".

    Example:
        >>> SourceLocation().cell(17, "q_knee")
        'row 17, column q_knee'
        >>> SourceLocation("log.csv", np.array([2, 3]), {"q_knee": "pos2"}).cell(1, "q_knee")
        'log.csv, line 3, column pos2 (q_knee)'
    """

    file: str = ""
    lines: NDArray[np.int64] | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    counted: str = "line"

    def row(self, row: int) -> str:
        """Name a row: "row 17" (counted from 0) of an array, "log.csv, line 19" of a file."""
        if self.lines is not None:
            return f"{self.file}, {self.counted} {self.lines[row]}"
        return f"{self.file}, row {row}" if self.file else f"row {row}"

    def column(self, column: str) -> str:
        """Name a column by the file's header and, if that differs, by exoid's name too."""
        header = self.headers.get(column, column)
        return column if header == column else f"{header} ({column})"

    def cell(self, row: int, column: str) -> str:
        """Name one value."""
        return f"{self.row(row)}, column {self.column(column)}"
