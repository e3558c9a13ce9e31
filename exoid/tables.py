"""Tables as plain text for terminals, and as HTML for notebooks."""

from __future__ import annotations

import html
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

WIDTH = 110


@dataclass(frozen=True)
class DataTable:
    """A table for terminals and pages, whose first column names the rows.

    Attributes:
        caption: Line above the table; "" for none.
        headers: Headers of the columns.
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


def to_html(*parts: DataTable | str) -> str:
    """Render tables, with their captions, and lines as HTML, such as a ``_repr_html_`` returns to a notebook.

    Args:
        parts: Tables, and lines of text, which are escaped.

    Returns:
        ``<table>`` and ``<p>`` elements.
    """
    return "".join(
        html_table(part.headers, part.rows, part.caption)
        if isinstance(part, DataTable)
        else f"<p>{html.escape(part)}</p>"
        for part in parts
    )


def html_table(headers: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "") -> str:
    """Render a table as HTML, such as a ``_repr_html_`` returns to a notebook.

    Args:
        headers: Headers of the columns; none for a table without a header.
        rows: Cells as text, which is escaped; the first cell names the row, the others are aligned right.
        caption: Line above the table; "" for none.

    Returns:
        One ``<table>`` element.

    Example:
        >>> html_table(("joint", "q [rad]"), [("knee", "-1.2 … 0.0")], caption="swing.csv")[:46]
        '<table><caption style="text-align:left">swing.'
    """

    def line(tag: str, cells: Sequence[str]) -> str:
        sides = ("left", *("right",) * (len(cells) - 1))
        row = (
            f'<{tag} style="text-align:{side}">{html.escape(c)}</{tag}>' for side, c in zip(sides, cells, strict=True)
        )
        return f"<tr>{''.join(row)}</tr>"

    top = f'<caption style="text-align:left">{html.escape(caption)}</caption>' if caption else ""
    head = f"<thead>{line('th', headers)}</thead>" if headers else ""
    return f"<table>{top}{head}<tbody>{''.join(line('td', row) for row in rows)}</tbody></table>"


def with_error(value: float, std: float, *bounds: float) -> tuple[str, ...]:
    """Write a value, its standard deviation and bounds, all to the second digit of the deviation.

    Args:
        value: The value.
        std: Its standard deviation.
        *bounds: Bounds, such as those of an interval.

    Returns:
        Each number as text.

    Example:
        >>> with_error(1.962817, 0.00131, 1.96025, 1.96538)
        ('1.9628', '0.0013', '1.9603', '1.9654')
    """
    decimals = max(0, 1 - int(f"{std:e}".split("e")[1])) if 0.0 < std < float("inf") else 9
    if decimals > 8:  # as good as exact
        return f"{value:.6g}", f"{std:.1e}", *(f"{bound:.6g}" for bound in bounds)
    return tuple(f"{number:.{decimals}f}" for number in (value, std, *bounds))
