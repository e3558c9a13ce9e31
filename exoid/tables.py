"""Tables as people read them, in a terminal or in a string."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

WIDTH = 110


@dataclass(frozen=True)
class DataTable:
    """A table for terminals and pages alike, whose first column names its rows.

    Attributes:
        caption: Above it.
        headers: Of the columns.
        rows: Cells as text.
    """

    caption: str
    headers: Sequence[str]
    rows: Sequence[Sequence[str]]


def make_table(headers: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    """Make a table whose first column is text and whose others are numbers, aligned right."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for index, header in enumerate(headers):
        table.add_column(header, justify="left" if index == 0 else "right", overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def to_text(*parts: Table | DataTable | str) -> str:
    """Render tables, with their captions, and lines as plain text."""
    file = io.StringIO()
    console = Console(
        file=file,
        width=WIDTH,
        color_system=None,
        force_jupyter=False,  # there Rich would display the parts instead of writing them to the file
        highlight=False,
        markup=False,
        emoji=False,
    )
    for part in parts:
        if isinstance(part, DataTable):
            console.print(part.caption)
            console.print(make_table(part.headers, part.rows))
        else:
            console.print(part)
    return "\n".join(line.rstrip() for line in file.getvalue().splitlines()).strip("\n")


def with_error(value: float, std: float, *bounds: float) -> tuple[str, ...]:
    """Write a value, its standard deviation and bounds of it, all to the second digit of the deviation.

    Example:
        >>> with_error(1.962817, 0.00131, 1.96025, 1.96538)
        ('1.9628', '0.0013', '1.9603', '1.9654')
    """
    decimals = max(0, 1 - int(f"{std:e}".split("e")[1])) if 0.0 < std < float("inf") else 9
    if decimals > 8:  # as good as exact
        return f"{value:.6g}", f"{std:.1e}", *(f"{bound:.6g}" for bound in bounds)
    return tuple(f"{number:.{decimals}f}" for number in (value, std, *bounds))


def value_range(values: Iterable[float]) -> str:
    """Write the range of some values, or the value if all are equal.

    Args:
        values: At least one number.

    Returns:
        Smallest and largest value to three digits.

    Example:
        >>> value_range([2.0, 0.5, 1.0])
        '0.5 to 2'
    """
    numbers = list(values)
    return " to ".join(dict.fromkeys(f"{end:.3g}" for end in (min(numbers), max(numbers))))
