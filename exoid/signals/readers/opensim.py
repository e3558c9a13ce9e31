"""OpenSim's motion and storage files (``.mot``, ``.sto``): a header up to ``endheader``, then columns of numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence

from exoid.errors import UnreadableInputError

from .options import ReadRequest
from .table import Table, refuse_columns
from .text import read_text, refuse_repeated, split_lines, text_table

ROWS, COLUMNS = ("nrows", "datarows"), ("ncolumns", "datacolumns")
"""Entries of the header that state the size, of OpenSim and of SIMM."""

ENTRY = re.compile(r"(\w+)\s*[=\s]\s*(\S+)\s*$")
"""``nRows=500`` of OpenSim, ``datarows 500`` of SIMM."""

TRANSLATIONS = ("_tx", "_ty", "_tz")
"""Ends of the names of coordinates in m, which ``inDegrees`` does not concern."""

SENTENCE = re.compile(r"angles are in (degrees|radians)", re.IGNORECASE)
"""What older files say instead of ``inDegrees``."""


def read_opensim_table(file: str, request: ReadRequest) -> Table:
    """Read a motion or storage file of OpenSim, or of SIMM."""
    # The header states `nRows` and `nColumns` (`datarows` and `datacolumns` of SIMM; OpenSim 4 leaves both out)
    # and `inDegrees`. Angles of a file that does not say are in radians, as for OpenSim. Columns are separated by tabs
    # or spaces.
    text, source = read_text(file)
    content, _ = split_lines(text)
    end = next((k for k, (_, line) in enumerate(content) if line.strip().lower() == "endheader"), None)
    if end is None or end + 1 == len(content):
        raise UnreadableInputError(
            "no line 'endheader'" if end is None else "nothing follows 'endheader'",
            remedy="check that the file is complete, and OpenSim's; name other logs .csv",
        )
    entries, degrees = _header_entries([line for _, line in content[:end]])
    names = content[end + 1][1].strip()  # a tab at the end of the line is no further column
    header = [name.strip() for name in names.split("\t")] if "\t" in names else names.split()
    refuse_columns(len(header))
    refuse_repeated(header)
    rows = content[end + 2 :]
    _refuse_other_size(entries, COLUMNS, len(header), "columns follow")
    _refuse_other_size(entries, ROWS, len(rows), "rows follow")
    cells = [(number, "\t".join(line.split())) for number, line in rows]
    return text_table(file, source, header, cells, "\t", in_degrees=frozenset(header if degrees else ()))


def _header_entries(lines: Sequence[str]) -> tuple[dict[str, str], bool]:
    """Take entries by name in lower case, and whether angles are in degrees."""
    entries: dict[str, str] = {}
    said: set[bool] = set()
    for line in lines:
        sentence, entry = SENTENCE.search(line), ENTRY.match(line.strip())
        if sentence is not None:
            said.add(sentence.group(1).lower() == "degrees")
        elif entry is not None:
            name, value = entry.group(1).lower(), entry.group(2)
            if name == "indegrees":
                if value.lower() not in ("yes", "no", "true", "false", "1", "0"):
                    raise UnreadableInputError(f"inDegrees is {value!r}", remedy="write inDegrees=yes or inDegrees=no")
                said.add(value.lower() in ("yes", "true", "1"))
            elif entries.setdefault(name, value) != value and name in ROWS + COLUMNS:
                raise UnreadableInputError(
                    f"the header states {entry.group(1)} twice", remedy="write the file again, or correct its header"
                )
    if len(said) > 1:
        raise UnreadableInputError(
            "the header says both that angles are in degrees and that they are in radians",
            remedy="write the file again, or correct its header",
        )
    return entries, True in said


def _refuse_other_size(entries: dict[str, str], names: Sequence[str], size: int, what: str) -> None:
    """Refuse a size that differs from what the header states."""
    for name in names:
        stated = entries.get(name)
        if stated is not None and not (stated.isdecimal() and stated.lstrip("0") == str(size).lstrip("0")):
            raise UnreadableInputError(
                f"the header states {name} {stated[:20]!r}, but {size} {what}",
                remedy="check that the file is complete, and correct its header if it is",
            )
