"""Bounds of logs: columns and blank lines."""

from __future__ import annotations

from exoid.errors import UnreadableInputError

MOST_COLUMNS = 10_000
"""Largest number of columns of a log; humanoids have some hundreds."""

MOST_BLANK_LINES = 1_000_000
"""Largest number of blank lines and comments beyond one for each line with data."""


def refuse_columns(count: int, file: str) -> None:
    """Refuse a file with more columns than any log has."""
    if count > MOST_COLUMNS:
        raise UnreadableInputError(
            f"{count} columns, more than {MOST_COLUMNS}", where=file, remedy="write the columns of one leg's joints"
        )
