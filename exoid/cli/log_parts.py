"""Segments and payloads of logs: those of one log, and refusal of those of logs that were not given."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from exoid.errors import BadArgumentError, ExoidError, UnreadableInputError
from exoid.leg.payload import FORM, Payload

from .options import LogOptions
from .refusals import unreadable


def refuse_other(options: LogOptions, logs: Sequence[str]) -> None:
    """Refuse segments and payloads of logs that were not given, or that do not say which of several they belong to."""
    known = {name for log in logs for name in (log, Path(log).name)}
    named = {name for name, _ in _segment_lines(options.segments)}
    if None in named and len(logs) > 1:
        where = str(options.segments)
        raise BadArgumentError("segments do not say which log they belong to", where=where, remedy="add a column log")
    for name in sorted(named - {None} - known, key=str):
        what = f"segments of {name}, which is not among the logs"
        raise BadArgumentError(what, where=str(options.segments), remedy="check its name")
    for option in options.payload or ():
        name, _ = _payload(option)
        if name is not None and name not in known:
            raise BadArgumentError(f"--payload {option}: {name} is not among the logs", remedy="check its name")


def segments_of(file: str, log: str) -> list[tuple[float, float]]:
    """Read the segments of a log that count: start and stop [s]."""
    found = [pair for name, pair in _segment_lines(file) if name is None or name in (log, Path(log).name)]
    if not found:
        raise BadArgumentError(f"no segments of {log}", where=file, remedy="name it in the column log")
    return found


def payloads_of(options: Sequence[str] | None, log: str) -> tuple[Payload, ...] | None:
    """Find the payloads of a log."""
    found = [_payload(option) for option in options or ()]
    return tuple(payload for name, payload in found if name is None or name in (log, Path(log).name)) or None


def _payload(option: str) -> tuple[str | None, Payload]:
    """Name of the log, and the payload, of "heavy.csv=shank:3.0@0,0,-0.3"."""
    name, found, text = option.rpartition("=")
    try:
        return (name if found else None), Payload.from_text(text)
    except ExoidError as error:
        raise BadArgumentError(f"--payload {option}: {error.what}", remedy=error.remedy or f"write {FORM}") from None


def _segment_lines(file: str | None) -> list[tuple[str | None, tuple[float, float]]]:
    """Name of the log, where there is one, with start and stop of each segment."""
    if file is None:
        return []
    try:
        with Path(file).open(newline="", encoding="utf-8-sig") as opened:
            rows = list(csv.DictReader(opened, skipinitialspace=True))
    except (OSError, ValueError, csv.Error) as error:
        raise unreadable(file, error) from None
    lines = []
    for number, row in enumerate(rows, start=2):
        try:
            lines.append((row.get("log") or None, (float(row["start"]), float(row["stop"]))))
        except (KeyError, TypeError, ValueError):
            remedy = "write a header start,stop and two numbers a line [s]"
            where = f"{file}, line {number}"
            raise UnreadableInputError("a line without start and stop", where=where, remedy=remedy) from None
    if not lines:
        remedy = "write start,stop and two numbers a line [s]"
        raise UnreadableInputError("there are no segments", where=file, remedy=remedy)
    return lines
