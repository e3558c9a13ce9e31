"""Tables as plain text for terminals, and as HTML for notebooks."""

from __future__ import annotations

import html
import io
import textwrap
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from unicodedata import combining, east_asian_width

WIDTH = 110
"""Longest line of a text, unless a terminal is narrower."""

NARROWEST = 60
"""Longest line of a text on any narrower terminal."""

line_width: ContextVar[int] = ContextVar("line_width", default=WIDTH)
"""Longest line of a text. The command sets it to the width of its terminal, between the two above."""


@dataclass(frozen=True)
class DataTable:
    """A table for terminals and pages, whose first column names the rows."""

    caption: str  # line above the table; "" for none
    headers: Sequence[str]  # headers of the columns
    rows: Sequence[Sequence[str]]  # cells as text


def make_table(headers: Sequence[str], rows: Iterable[Sequence[str]]) -> DataTable:
    """Make a table without a caption."""
    return DataTable("", tuple(headers), tuple(rows))


def to_text(*parts: DataTable | str) -> str:
    """Render tables, with their captions, and lines as plain text."""
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
        for piece in _pieces(part, console.width):
            file.write("\n".join(("", *piece, "", "")))
    text = "\n".join(line.rstrip() for line in file.getvalue().splitlines()).strip("\n")
    return text.replace("\n\n\n", "\n\n")  # a table has an empty line above and below


def _pieces(table: DataTable, most: int) -> Iterator[list[str]]:
    """Cut a table into tables of at most so many characters a line, each with the first column."""
    first, last = 1, len(table.headers)
    while first < last:  # columns that do not fit beside each other go into a table below
        headers, rows = (
            (table.headers[0], *table.headers[first:last]),
            [(row[0], *row[first:last]) for row in table.rows],
        )
        columns = headers, rows
        # Widest table with wide gaps between its columns; in a wider one they are a character narrower
        lines = _drawn(*columns, min(80, most), 3, _width) or _drawn(*columns, most, 2, _unbroken)
        if lines is not None or last == first + 1:
            yield lines or _drawn(*columns, most, 2, _letter) or []
            first, last = last, len(table.headers)
        else:
            last -= 1
    if len(table.headers) == 1:
        yield _drawn(table.headers, table.rows, most, 3, _letter) or []


def _drawn(
    headers: Sequence[str], rows: Sequence[Sequence[str]], most: int, gap: int, kept: Callable[[str], int]
) -> list[str] | None:
    """Lay out a table: the first column is aligned left, the others right."""
    columns = list(zip(headers, *rows, strict=True))
    widths = [max(map(_width, column)) for column in columns]
    least = [max(map(kept, column)) for column in columns]
    room = most - 2 - gap * (len(widths) - 1)
    if sum(least) > room:
        return None
    while sum(widths) > room:
        widest = max(range(len(widths)), key=lambda k: (widths[k] > least[k], widths[k]))
        widths[widest] -= 1
    rule = " " + "─" * (sum(widths) + gap * (len(widths) - 1))
    return [
        *_row(headers, widths, gap, below=True),
        rule,
        *(line for row in rows for line in _row(row, widths, gap, below=False)),
    ]


def _row(cells: Sequence[str], widths: Sequence[int], gap: int, *, below: bool) -> list[str]:
    """Lines of a row; cells of fewer lines stand below or above."""
    wrapped = [
        [cell] if _width(cell) <= width else textwrap.wrap(cell, width, break_on_hyphens=False)
        for cell, width in zip(cells, widths, strict=True)
    ]
    count = max(map(len, wrapped))
    missing = [[""] * (count - len(lines)) for lines in wrapped]
    filled = [none + lines if below else lines + none for none, lines in zip(missing, wrapped, strict=True)]
    lines = []
    for parts in zip(*filled, strict=True):
        blanks = [" " * (width - _width(part)) for part, width in zip(parts, widths, strict=True)]
        first = parts[0] + blanks[0]
        others = (blank + part for blank, part in zip(blanks[1:], parts[1:], strict=True))
        lines.append(" " + (" " * gap).join((first, *others)))
    return lines


def _width(text: str) -> int:
    """Number of places that a text takes on a terminal."""
    return sum(0 if combining(letter) else 1 + (east_asian_width(letter) in "WF") for letter in text)


def _letter(cell: str) -> int:
    """Length of what stays on one line where even words are broken."""
    return min(1, len(cell))


def _unbroken(cell: str) -> int:
    """Length of what of a cell stays on one line: its longest word, or all of it if it is a number."""
    return max(map(_width, cell.split()), default=0) if any(map(str.isalpha, cell)) else _width(cell)


def to_html(*parts: DataTable | str) -> str:
    """Render tables, with their captions, and lines as HTML, such as a ``_repr_html_`` returns to a notebook."""

    def row(tag: str, cells: Sequence[str]) -> str:
        """Write a row, the first cell to the left."""
        sides = ("left", *("right",) * (len(cells) - 1))
        each = (f'<{tag} style="text-align:{x}">{html.escape(c)}</{tag}>' for x, c in zip(sides, cells, strict=True))
        return f"<tr>{''.join(each)}</tr>"

    texts = []
    for part in parts:
        if isinstance(part, str):
            texts.append(f"<p>{html.escape(part)}</p>")
            continue
        caption = f'<caption style="text-align:left">{html.escape(part.caption)}</caption>' if part.caption else ""
        head = f"<thead>{row('th', part.headers)}</thead>" if part.headers else ""
        texts.append(f"<table>{caption}{head}<tbody>{''.join(row('td', each) for each in part.rows)}</tbody></table>")
    return "".join(texts)


class Report(ABC):
    """Result that prints as tables and lines, and as HTML in a notebook."""

    @abstractmethod
    def _report(self) -> Sequence[DataTable | str]:
        """Tables and lines, from top to bottom."""

    def __str__(self) -> str:
        return to_text(*self._report())

    def _repr_html_(self) -> str:
        """Tables and lines for notebooks."""
        return to_html(*self._report())


def with_parts(
    headers: Sequence[str], rows: Iterable[Sequence[str]], parts: Sequence[tuple[str, Iterable[Sequence[str]]]]
) -> list[DataTable | str]:
    """Make a table of several recordings, and one of each recording below it."""
    table = make_table(headers, rows)
    if not parts:
        return [table]
    of_parts = [(name, *row) for name, rows in parts for row in rows]
    return [table, "each recording:", make_table(("recording", *headers), of_parts)]


def with_error(value: float, std: float, *bounds: float) -> tuple[str, ...]:
    """Write a value, its standard deviation and bounds, all to the second digit of the deviation."""
    decimals = max(0, 1 - int(f"{std:e}".split("e")[1])) if 0.0 < std < float("inf") else 9
    if decimals > 8:  # as good as exact
        return f"{value:.6g}", f"{std:.1e}", *(f"{bound:.6g}" for bound in bounds)
    return tuple(f"{number:.{decimals}f}" for number in (value, std, *bounds))


def value_range(values: Iterable[float]) -> str:
    """Write the range of some values, or the value if all are equal."""
    numbers = list(values)
    return " to ".join(dict.fromkeys(f"{end:.3g}" for end in (min(numbers), max(numbers))))
