"""Tables as plain text for terminals, and as HTML for notebooks."""

from __future__ import annotations

import html
import io
from collections.abc import Iterable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

WIDTH = 110
"""Longest line of a text, unless a terminal is narrower."""

NARROWEST = 60
"""Longest line of a text on any narrower terminal."""

COMPACT = 80
"""Widest table with wide gaps between its columns; in a wider one they are a character narrower."""

line_width: ContextVar[int] = ContextVar("line_width", default=WIDTH)
"""Longest line of a text. The command sets it to the width of its terminal, between the two above."""


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
        Lines of at most :data:`line_width` characters, without blanks at their ends. A table wider than that or than
        :data:`COMPACT` gets narrower gaps. If it is still too wide, it is cut into tables of some of its columns, each
        with the first column.
    """
    from rich.console import Console  # noqa: PLC0415 - a leg and an estimate need Rich only when they are printed

    file = io.StringIO()
    console = Console(
        file=file,
        width=line_width.get(),
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
        for piece in _pieces(part, console):
            console.print(piece)
    text = "\n".join(line.rstrip() for line in file.getvalue().splitlines()).strip("\n")
    return text.replace("\n\n\n", "\n\n")  # a table has an empty line above and below


def _pieces(table: DataTable, console: Console) -> Iterator[Table]:
    """Cut a table into tables that fit the console, each with the first column."""
    unlimited = console.options.update(max_width=10 * WIDTH)
    first, last = 1, len(table.headers)
    while first < last:  # columns that do not fit beside each other go into a table below
        columns = _columns(table, first, last)
        piece = _drawn(*columns, gap=3)
        if console.measure(piece, options=unlimited).maximum > min(COMPACT, console.width):
            piece = _drawn(*columns, gap=2)
        if last == first + 1 or console.measure(piece, options=unlimited).minimum <= console.width:
            yield piece
            first, last = last, len(table.headers)
        else:
            last -= 1
    if len(table.headers) == 1:
        yield _drawn(table.headers, table.rows, gap=3)


def _drawn(headers: Sequence[str], rows: Sequence[Sequence[str]], gap: int) -> Table:
    """Lay out a table with so many blanks between its columns, two or three."""
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415 - as above
    from rich.table import Table  # noqa: PLC0415

    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, gap - 2))
    for index, column in enumerate(zip(headers, *rows, strict=True)):
        least = max(map(_unbroken, column), default=0)
        table.add_column(headers[index], justify="left" if index == 0 else "right", overflow="fold", min_width=least)
    for row in rows:
        table.add_row(*row)
    return table


def _unbroken(cell: str) -> int:
    """Length of what of a cell stays on one line: its longest word, or all of it if it is a number."""
    return max(map(len, cell.split()), default=0) if any(map(str.isalpha, cell)) else len(cell)


def _columns(table: DataTable, first: int, last: int) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
    """Headers and rows of the first column and those from ``first`` to before ``last``."""
    return (table.headers[0], *table.headers[first:last]), [(row[0], *row[first:last]) for row in table.rows]


def to_html(*parts: DataTable | str) -> str:
    """Render tables, with their captions, and lines as HTML, such as a ``_repr_html_`` returns to a notebook.

    Args:
        *parts: Tables, and lines of text, which are escaped.

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
        """Write a row of HTML, the first cell to the left."""
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
