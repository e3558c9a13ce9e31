"""Tables as people read them, in a terminal or in a string."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

WIDTH = 110


def make_table(headers: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    """Make a table whose first column is text and whose others are numbers, aligned right."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for index, header in enumerate(headers):
        table.add_column(header, justify="left" if index == 0 else "right", overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def to_text(*parts: Table | str) -> str:
    """Render tables and lines as plain text."""
    file = io.StringIO()
    console = Console(file=file, width=WIDTH, color_system=None, highlight=False, markup=False, emoji=False)
    for part in parts:
        console.print(part)
    return "\n".join(line.rstrip() for line in file.getvalue().splitlines()).strip("\n")


def with_error(value: float, std: float) -> tuple[str, str]:
    """Write a value and its standard deviation, both to the second digit of the latter.

    Example:
        >>> with_error(1.962817, 0.00131)
        ('1.9628', '0.0013')
    """
    if not std > 0.0 or std == float("inf"):
        return f"{value:.6g}", f"{std:.2g}"
    first_digit = int(f"{std:e}".split("e")[1])
    decimals = max(0, 1 - first_digit)
    if decimals > 8:
        return f"{value:.6g}", f"{std:.1e}"
    return f"{value:.{decimals}f}", f"{std:.{decimals}f}"
