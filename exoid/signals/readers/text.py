"""Text files as header and numbers: delimiters, comments, and the line of an error."""

from __future__ import annotations

import csv
import hashlib
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals.source import Source

from .bounds import MOST_BLANK_LINES, refuse_columns

DELIMITERS = (",", ";", "\t")

PAYLOAD = "# payload:"
"""Beginning of a line that names a payload, such as ``# payload: knee:3.0@0,0,-0.3``."""

BASE_POSITION = "# base position:"
"""Beginning of a line that gives the position of the sensor on the base [m], ``# base position: 0.1,0,0.2``."""

WRENCH = "# wrench:"
"""Beginning of a line that gives the axes of a wrench and its point [m], ``# wrench: left_foot:link@0,0,-0.08``."""

SAID = (PAYLOAD, BASE_POSITION, WRENCH)
"""Beginnings of lines that are read."""

BLOCK = 2**20
"""Least number of characters that are split into lines at once."""


@dataclass(frozen=True)
class TextTable:
    """Header and data lines of a delimited text file.

    Attributes:
        file: Path as the caller gave it, for messages.
        source: Name and SHA-256 of the file.
        header: Column names without outer spaces.
        rows: Data lines, N of them.
        lines: Line number of each data line, from 1, (N,).
        delimiter: Delimiter, one of ``DELIMITERS``.
        payloads: Text of each payload that a line ``# payload: …`` above the data names.
        base_positions: Text of each line ``# base position: …``.
        wrenches: Text of each line ``# wrench: …``.
        in_degrees: Whether the file says that its angles are in degrees, as OpenSim's do.
    """

    file: str
    source: Source
    header: tuple[str, ...]
    rows: Sequence[str]
    lines: NDArray[np.int64]
    delimiter: str
    payloads: tuple[str, ...] = ()
    base_positions: tuple[str, ...] = ()
    wrenches: tuple[str, ...] = ()
    in_degrees: bool = False

    @property
    def row_name(self) -> str:
        """Word for a row in messages."""
        return "line"

    def __len__(self) -> int:
        return len(self.rows)

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Parse columns; other columns may hold text. A column without any entry is NaN throughout.

        Args:
            columns: Names of k columns.

        Returns:
            Numbers, (N, k), which may be NaN or infinite.

        Raises:
            ExoidError: A row has a wrong number of cells, a cell is empty or not a number (names line and column), or
                two columns have the name of one that is read.
        """
        refuse_repeated([name for name in self.header if name in columns], self.file)
        self._refuse_ragged()
        places = [self.header.index(column) for column in columns]
        try:
            return self._parsed(places)
        except ValueError as problem:
            filled = [place for place in places if place not in self._empty(places)]
            if not filled or len(filled) == len(places):
                raise self._bad_cell(places, problem) from None
        out = np.full((len(self.rows), len(places)), np.nan)
        try:
            out[:, [place in filled for place in places]] = self._parsed(filled)
        except ValueError as problem:
            raise self._bad_cell(filled, problem) from None
        return out

    def _parsed(self, places: Sequence[int]) -> FloatArray:
        quote = '"' if any('"' in row for row in self.rows) else None
        table = np.loadtxt(self.rows, delimiter=self.delimiter, usecols=places, ndmin=2, comments=None, quotechar=quote)
        if len(table) != len(self.rows):
            raise ExoidError("a quotation mark opens and does not close", where=self.file, remedy="remove the quotes")
        return np.asarray(table, dtype=np.float64)

    def _empty(self, places: Sequence[int]) -> set[int]:
        """Columns without any entry."""
        left = set(places)
        for line, row in zip(self.lines, self.rows, strict=True):
            if not left:
                break
            cells = _cells(row, self.delimiter, f"{self.file}, line {line}")
            left = {place for place in left if place >= len(cells) or not cells[place]}
        return left

    def _refuse_ragged(self) -> None:
        for line, row in zip(self.lines, self.rows, strict=True):
            where = f"{self.file}, line {line}"
            width = len(_cells(row, self.delimiter, where)) if '"' in row else row.count(self.delimiter) + 1
            if width != len(self.header):
                raise ExoidError(
                    f"{width} cells, but the header has {len(self.header)} columns",
                    where=where,
                    remedy="correct or drop that row (decimal commas split cells: write 0.5, not 0,5)",
                )

    def _bad_cell(self, places: Sequence[int], problem: ValueError) -> ExoidError:
        """Make the error about the first cell that is not a number, after the fast reader has failed."""
        for line, row in zip(self.lines, self.rows, strict=True):
            cells = _cells(row, self.delimiter, f"{self.file}, line {line}")
            for column in places:
                cell = cells[column] if column < len(cells) else ""
                if _is_number(cell):
                    continue
                what, remedy = f"{cell[:40]!r} is not a number", "correct or drop that row"
                if not cell:
                    what, remedy = "the cell is empty", "drop that row, or fill it by a documented method"
                elif _is_number(cell.replace(",", ".")):
                    remedy = "write numbers with a decimal point"
                return ExoidError(what, where=f"{self.file}, line {line}, column {self.header[column]}", remedy=remedy)
        return ExoidError(f"unreadable: {problem}", where=self.file, remedy="write plain decimal numbers")


def read_text_table(path: str | os.PathLike[str], names: Sequence[str] | None = None) -> TextTable:
    """Read a UTF-8 text file with a header line, delimited by comma, semicolon or tab; numbers alone also by spaces.

    Blank lines and lines that start with ``#`` are skipped. A byte-order mark and any line ending are accepted. If the
    first line has only numbers, the ``#`` line before it with the same number of cells is the header.

    Args:
        path: The file.
        names: Names of the columns of a file without a header line, "" for one that is not read; None where it has one.

    Returns:
        The table.

    Raises:
        ExoidError: The file is missing, empty or not text, or its header is missing.
    """
    file = os.fsdecode(path)
    text, source = read_text(file)
    content, comments = split_lines(text, file)
    if not content:
        raise ExoidError("no lines with data", where=file, remedy="a log has a header line, then one line per sample")
    number, first = content[0]
    delimiter = max(DELIMITERS, key=lambda mark: len(_cells(first, mark, f"{file}, line {number}")))
    if delimiter not in first and all(map(_is_number, first.split())):
        content, comments = _with_commas(content), [line if "," in line else _commas(line) for line in comments]
        first, delimiter = content[0][1], ","
    header = _cells(first, delimiter, f"{file}, line {number}")
    if names is not None:
        header = _given_names(names, header, f"{file}, line {number}")
    elif all(map(_is_number, header)):
        header = _cells(comments[-1].lstrip("# \t"), delimiter, file) if comments else []
        if len(header) != first.count(delimiter) + 1:
            raise ExoidError(
                "no header line: the first line holds only numbers",
                where=f"{file}, line {number}",
                remedy='pass names=("time", "q_<joint>", "tau_<joint>", ...), "" for columns that are not read, or put '
                "a line of column names first",
                command="give the names of its columns: --names time,q_<joint>,tau_<joint>, nothing between two commas "
                "for a column that is not read",
            )
    else:
        content = content[1:]
    refuse_columns(len(header), file)
    rows = [(number, line) for number, line in content if line.strip(f'{delimiter}" \t')]
    lines = np.array([number for number, _ in rows], dtype=np.int64)
    data_line = rows[0][0] if rows else number
    payloads, positions, wrenches = (_said(text, word, data_line) for word in SAID)
    texts = [line for _, line in rows]
    return TextTable(file, source, tuple(header), texts, lines, delimiter, payloads, positions, wrenches)


def refuse_repeated(header: Sequence[str], file: str) -> None:
    """Refuse two columns of one name; such as are not read may have one ("Unused")."""
    for name, count in Counter(header).items():
        if name and count > 1:
            raise ExoidError(f"{count} columns are headed {name!r}", where=file, remedy="rename or drop one")


def _said(text: str, word: str, data_line: int) -> tuple[str, ...]:
    """Take what lines before the data say behind a word."""
    if word not in text:
        return ()
    above = (line.strip() for line in text.split("\n", data_line)[: data_line - 1])
    return tuple(line.removeprefix(word).strip() for line in above if line.startswith(word))


def _with_commas(content: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Separate cells by commas where they were separated by spaces."""
    return [(number, _commas(line)) for number, line in content]


def _commas(line: str) -> str:
    return ",".join(line.lstrip("# \t").split())


def _given_names(names: Sequence[str], first: Sequence[str], where: str) -> list[str]:
    """Check names of columns against the first line of a file without a header line."""
    if isinstance(names, str):
        raise ExoidError(f"names is the string {names!r}", remedy=f"pass names={tuple(names.split(','))!r}")
    if not all(_is_number(cell) or not cell for cell in first):
        raise ExoidError(
            f"names are given, but the file has a header line: {', '.join(first[:20])}",
            where=where,
            remedy="leave out names, and map its headers by columns",
            command="leave out --names, and map its headers by --column",
        )
    if len(names) != len(first):
        raise ExoidError(
            f"{len(names)} names for {len(first)} columns",
            where=where,
            remedy='name every column, "" where it is not read',
            command="name every column, with nothing between two commas where it is not read",
        )
    return [str(name).strip() for name in names]


def read_text(file: str) -> tuple[str, Source]:
    """Read a file of UTF-8 text; line ends become single characters."""
    data = _read_bytes(Path(file), file)
    text = _decode(data, file).replace("\r\n", "\n").replace("\r", "\n")
    return text, Source(name=Path(file).name, sha256=hashlib.sha256(data).hexdigest())


def split_lines(text: str, file: str) -> tuple[list[tuple[int, str]], list[str]]:
    """Split text into numbered lines with data, and the comments before the first of them."""
    content: list[tuple[int, str]] = []
    comments: list[str] = []
    number = 0
    for start, stop in _blocks(text):
        for line in text[start:stop].removesuffix("\n").split("\n"):
            number += 1
            plain = line.strip()
            if not plain:
                continue
            if not plain.startswith("#"):
                content.append((number, line))
            elif not content and not plain.startswith(SAID):
                comments = [line]
        if number - len(content) > MOST_BLANK_LINES + len(content):
            raise ExoidError(
                f"{number - len(content)} blank lines and comments among the first {number} lines",
                where=file,
                remedy="check that the logger wrote the file; remove these lines",
            )
    return content, comments


def _blocks(text: str) -> Iterator[tuple[int, int]]:
    """Places of blocks of whole lines: a file of blank lines is not split into a list of all of them."""
    start = 0
    while start < len(text):
        stop = text.find("\n", start + BLOCK) + 1 or len(text)
        yield start, stop
        start = stop


def _read_bytes(path: Path, file: str) -> bytes:
    try:
        if path.is_dir():
            os.stat(os.path.join(path, "."))  # noqa: PTH116, PTH118 - an error if the folder cannot be read
            raise ExoidError("is a directory, not a file", where=file, remedy="name the CSV file in it")
        if path.exists() and not path.is_file():
            raise ExoidError("is not a regular file", where=file, remedy="copy the log into a file first")
        return path.read_bytes()
    except FileNotFoundError:
        raise ExoidError("no such file", where=file, remedy=f"check the path; looked in {path.parent}") from None
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        where = file if file.isprintable() else repr(file)
        raise ExoidError(f"cannot be read ({reason})", where=where, remedy="check the path and its rights") from None


def _decode(data: bytes, file: str) -> str:
    if not data.strip():
        raise ExoidError("the file is empty", where=file, remedy="check that the logger closed it")
    if b"\0" in data:
        raise ExoidError("the file is binary, not text", where=file, remedy="export it as CSV in UTF-8")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise ExoidError(
            f"byte {data[problem.start]:#04x} is not UTF-8 text",
            where=f"{file}, line {line}",
            remedy="save it as UTF-8",
        ) from None


def _cells(line: str, delimiter: str, where: str) -> list[str]:
    refuse_columns(line.count(delimiter) + 1, where)
    try:
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error as problem:
        raise ExoidError(
            f"not a line of a table: {problem}", where=where, remedy="export the log as plain CSV"
        ) from None
    return [cell.strip() for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return cell.isascii() and "_" not in cell
