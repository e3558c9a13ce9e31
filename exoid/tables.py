"""Tables as people read them, in a terminal or in a string."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

WIDTH = 110


@dataclass(frozen=True)
class DataTable:
    """A table for terminals and pages alike, whose first column names its rows.

    Attributes:
        caption: Line above it; empty for none.
        headers: Of the columns.
        rows: Cells as text.
    """

    caption: str
    headers: Sequence[str]
    rows: Sequence[Sequence[str]]


def make_table(headers: Sequence[str], rows: Iterable[Sequence[str]]) -> DataTable:
    """Make a table without a caption.

    Args:
        headers: Headers of the columns.
        rows: Cells as text, one sequence a row.

    Returns:
        The table: its first column is text, the others are numbers, aligned right.
    """
    return DataTable("", tuple(headers), tuple(rows))


def to_text(*parts: DataTable | str) -> str:
    """Render tables, with their captions, and lines as plain text.

    Args:
        *parts: Tables and lines, from top to bottom.

    Returns:
        Lines of at most ``WIDTH`` characters, without blanks at their ends.
    """
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415 - a leg and an estimate need Rich only when they are printed
    from rich.console import Console  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

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
        if isinstance(part, str):
            console.print(part)
            continue
        if part.caption:
            console.print(part.caption)
        table = Table(box=SIMPLE_HEAD, pad_edge=False)
        for index, header in enumerate(part.headers):
            table.add_column(header, justify="left" if index == 0 else "right", overflow="fold")
        for row in part.rows:
            table.add_row(*row)
        console.print(table)
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
