"""Segments of logs on the command line: ``--segments FILE.CSV``."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from exoid.errors import ExoidError

from .refusals import unreadable


def read_segments(path: Path, log: str) -> list[tuple[float, float]]:
    """Read the segments of a log that count."""
    found = [pair for name, pair in _segment_lines(path) if name is None or name in (log, Path(log).name)]
    if not found:
        raise ExoidError(f"no segments of {log}", where=str(path), remedy="name it in the column log")
    return found


def refuse_other_segments(file: str | None, logs: Sequence[str]) -> None:
    """Refuse segments that do not say which of several logs they belong to, or name a log that was not given."""
    if file is None:
        return
    path = Path(file)
    named = {name for name, _ in _segment_lines(path)}
    if None in named and len(logs) > 1:
        raise ExoidError("segments do not say which log they belong to", where=f"{path}", remedy="add a column log")
    for name in sorted(named - {None} - set(logs) - {Path(log).name for log in logs}, key=str):
        raise ExoidError(f"segments of {name}, which is not among the logs", where=str(path), remedy="check its name")


def _segment_lines(path: Path) -> list[tuple[str | None, tuple[float, float]]]:
    """Name of the log, where there is one, with start and stop of each segment."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file, skipinitialspace=True))
    except (OSError, ValueError, csv.Error) as error:
        raise unreadable(str(path), error) from None
    lines = []
    for number, row in enumerate(rows, start=2):
        try:
            lines.append((row.get("log") or None, (float(row["start"]), float(row["stop"]))))
        except (KeyError, TypeError, ValueError):
            raise ExoidError(
                "a line without start and stop",
                where=f"{path}, line {number}",
                remedy="write a header start,stop and two numbers a line [s]",
            ) from None
    if not lines:
        raise ExoidError("there are no segments", where=str(path), remedy="write start,stop and two numbers a line [s]")
    return lines
