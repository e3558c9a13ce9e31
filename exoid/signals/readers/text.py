"""Text files as header and numbers: delimiters, comments, and the line of an error."""

from __future__ import annotations

import csv
import hashlib
import io
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.signals.quantities import is_number
from exoid.signals.source import Source

from .options import ReadRequest
from .table import Table, refuse_columns

# Beginnings of lines above the data that are read
PAYLOAD = "# payload:"  # a payload, such as `# payload: knee:3.0@0,0,-0.3`
BASE_POSITION = "# base position:"  # position of the sensor on the base [m], `# base position: 0.1,0,0.2`
WRENCH = "# wrench:"  # axes of a wrench and its point [m], `# wrench: left_foot:link@0,0,-0.08`
SAID = (PAYLOAD, BASE_POSITION, WRENCH)

DELIMITERS = (",", ";", "\t")
LONGEST_LINE = 2**20  # 100 bytes for each of the most columns
OPEN_QUOTE = re.compile(rb'(?!\s*#)(?:.*[,;\t])? *"[^"]*(?:""[^"]*)*$')  # perhaps the last cell of a line is not closed


@dataclass(frozen=True)
class TextCells:
    """Header and data lines of a delimited text file."""

    header: tuple[str, ...]
    rows: Sequence[str]  # data lines, N of them
    lines: NDArray[np.int64]  # line number of each data line, from 1, (N,)
    delimiter: str

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Parse columns; other columns may hold text. A column without any entry is NaN throughout."""
        refuse_repeated([name for name in self.header if name in columns])
        self._refuse_ragged()
        places = [self.header.index(column) for column in columns]
        try:
            return self._parsed(places)
        except ValueError:
            filled = self._filled(places)
        out = np.full((len(self.rows), len(places)), np.nan)
        try:
            out[:, [place in filled for place in places]] = self._parsed([place for place in places if place in filled])
        except ValueError as problem:
            raise UnreadableInputError(f"unreadable: {problem}", remedy="write plain decimal numbers") from None
        return out

    def _parsed(self, places: Sequence[int]) -> FloatArray:
        return np.loadtxt(self.rows, delimiter=self.delimiter, usecols=places, ndmin=2, comments=None, quotechar='"')

    def _refuse_ragged(self) -> None:
        for line, row in zip(self.lines, self.rows, strict=True):
            where = f"line {line}"
            width = len(_cells(row, self.delimiter, where)) if '"' in row else row.count(self.delimiter) + 1
            if width != len(self.header):
                raise UnreadableInputError(
                    f"{width} cells, but the header has {len(self.header)} columns",
                    where=where,
                    remedy="correct or drop that row (decimal commas split cells: write 0.5, not 0,5)",
                )

    def _filled(self, places: Sequence[int]) -> set[int]:
        """Find the columns with entries after the fast reader has failed, and refuse a cell that is not a number."""
        filled: set[int] = set()
        wrong: dict[int, tuple[int, int, str]] = {}
        for line, row in zip(self.lines.tolist(), self.rows, strict=True):
            cells = _cells(row, self.delimiter, f"line {line}")
            filled.update(place for place in places if cells[place])
            for order, place in enumerate(places):
                if place not in wrong and not is_number(cells[place]):
                    wrong[place] = (line, order, cells[place])
        refused = [cell for place, cell in wrong.items() if place in filled or not filled]
        if refused:
            line, order, cell = min(refused)
            what, remedy = f"{cell[:40]!r} is not a number", "correct or drop that row"
            if not cell:
                what, remedy = "the cell is empty", "drop that row, or fill it by a documented method"
            elif is_number(cell.replace(",", ".")):
                remedy = "write numbers with a decimal point"
            name = self.header[places[order]]
            where = f"line {line}, column {name}"
            raise UnreadableInputError(what, where=where, remedy=remedy, column=name)
        return filled


def text_table(
    file: str,
    source: Source,
    header: Sequence[str],
    numbered: Sequence[tuple[int, str]],
    delimiter: str,
    **said: Any,  # noqa: ANN401 - what the file says above the data
) -> Table:
    """Make a table of data lines with their line numbers, which parses its columns when they are asked for."""
    lines = np.array([number for number, _ in numbered], dtype=np.int64)
    cells = TextCells(tuple(header), [line for _, line in numbered], lines, delimiter)
    return Table(file, source, cells.header, cells.numbers, len(numbered), lines, "line", **said)


def read_text_table(file: str, _: ReadRequest) -> Table:
    """Read a UTF-8 text file with a header line, delimited by comma, semicolon or tab; numbers alone also by spaces."""
    # Blank lines and lines that start with `#` are skipped. A byte-order mark and any line ending are accepted. If the
    # first line has only numbers, the `#` line before it with the same number of cells is the header.
    text, source = read_text(file)
    content, comments = split_lines(text)
    if not content:
        raise UnreadableInputError("no lines with data", remedy="a log has a header line, then one line per sample")
    number, first = content[0]
    where = f"line {number}"
    delimiter = max(DELIMITERS, key=lambda mark: len(_cells(first, mark, where)))
    if delimiter not in first and all(map(is_number, first.split())):
        content = [(number, _commas(line)) for number, line in content]
        comments = [line if "," in line else _commas(line) for line in comments]
        first, delimiter = content[0][1], ","
    header = _cells(first, delimiter, where)
    if all(map(is_number, header)):
        header = _cells(comments[-1].lstrip("# \t"), delimiter, "") if comments else []
        if len(header) != first.count(delimiter) + 1:
            raise UnreadableInputError(
                "no header line: the first line holds only numbers",
                where=where,
                remedy="put a line of column names first, such as time,q_<joint>,unread,tau_<joint>",
            )
    else:
        content = content[1:]
    refuse_columns(len(header))
    rows = [(number, line) for number, line in content if line.strip(f'{delimiter}" \t')]
    said = {}
    if any(word in text for word in SAID):
        data_line = rows[0][0] if rows else number
        above = [line.strip() for line in text.split("\n", data_line)[: data_line - 1]]
        said = {
            word: tuple(line.removeprefix(word).strip() for line in above if line.startswith(word)) for word in SAID
        }
    return text_table(file, source, header, rows, delimiter, said=said)


def refuse_repeated(header: Sequence[str]) -> None:
    """Refuse two columns of one name; such as are not read may have one ("Unused")."""
    for name, count in Counter(header).items():
        if name and count > 1:
            raise UnreadableInputError(f"{count} columns are headed {name!r}", remedy="rename or drop one", column=name)


def _commas(line: str) -> str:
    """Separate cells by commas where they were separated by spaces."""
    return ",".join(line.lstrip("# \t").split())


def read_text(file: str) -> tuple[str, Source]:
    """Read a file of UTF-8 text; line ends become single characters."""
    data = _read_bytes(Path(file))
    if not data.strip():
        raise UnreadableInputError("the file is empty", remedy="check that the logger closed it")
    try:
        text = data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise UnreadableInputError(
            f"byte {data[problem.start]:#04x} is not UTF-8 text",
            where=f"line {line}",
            remedy="save it as UTF-8",
        ) from None
    return text, Source(name=Path(file).name, sha256=hashlib.sha256(data).hexdigest())


def split_lines(text: str) -> tuple[list[tuple[int, str]], list[str]]:
    """Split text into numbered lines with data, and the comments before the first of them."""
    content: list[tuple[int, str]] = []
    comments: list[str] = []
    for number, line in enumerate(io.StringIO(text), 1):  # one at a time: a file of blank lines fills no memory
        plain = line.strip()
        if plain and not plain.startswith("#"):
            content.append((number, line.removesuffix("\n")))
        elif plain and not content and not plain.startswith(SAID):
            comments = [line.removesuffix("\n")]
    return content, comments


def _read_bytes(path: Path) -> bytes:
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise UnreadableInputError("is not a regular file", remedy="copy the log into a file first")
        begun, first = b"", 1  # part of a line that the block before ends with, and its number
        with path.open("rb") as opened:
            while block := opened.read(LONGEST_LINE):  # all is looked at before any of it is kept
                if b"\0" in block:  # before a sparse file of many gigabytes fills the memory
                    raise UnreadableInputError("the file is binary, not text", remedy="export it as CSV in UTF-8")
                whole = begun + block
                *lines, begun = whole.splitlines(keepends=True)
                if b'"' in whole:
                    _refuse_open_quotes(lines, first)
                first += len(lines)
                if len(begun) >= LONGEST_LINE:
                    raise UnreadableInputError("a line of over 1 MB", where=f"line {first}", remedy="break it up")
            _refuse_open_quotes([begun], first)
            size = opened.tell()
            opened.seek(0)
            return opened.read(size)
    except FileNotFoundError:
        raise UnreadableInputError("no such file", remedy=f"check the path; looked in {path.parent}") from None
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        raise UnreadableInputError(f"cannot be read ({reason})", remedy="check the path and its rights") from None


def _refuse_open_quotes(lines: Sequence[bytes], first: int) -> None:
    """Refuse a cell that its line does not end, before the rest of the file is read."""
    for number, line in enumerate(lines, first):
        if OPEN_QUOTE.match(line):
            for delimiter in DELIMITERS:
                _cells(line.decode("utf-8", "replace"), delimiter, f"line {number}")


def _cells(line: str, delimiter: str, where: str) -> list[str]:
    refuse_columns(line.count(delimiter) + 1)
    reader = csv.reader([line, ""], delimiter=delimiter, skipinitialspace=True)
    try:
        cells = next(reader, [])
    except csv.Error as problem:
        what = f"not a line of a table: {problem}"
        raise UnreadableInputError(what, where=where, remedy="export the log as plain CSV") from None
    if reader.line_num > 1:  # the parser takes all lines that follow for one cell
        raise UnreadableInputError("a quotation mark opens and does not close", where=where, remedy="remove the quotes")
    return [cell.strip() for cell in cells]
