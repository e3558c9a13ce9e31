"""Payloads on the command line: ``--payload heavy.csv=shank:3.0@0,0,-0.3``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from exoid.errors import ExoidError
from exoid.leg.payload import FORM, Payload

PayloadOptions = Annotated[
    list[str] | None,
    typer.Option(
        "--payload",
        metavar="[LOG=]SEGMENT:KG@X,Y,Z",
        help="Weighed body on a segment (joint or link), at X,Y,Z [m] in its frame, e.g. heavy.csv=shank:3.0@0,0,-0.3; "
        "without LOG= in all logs. Repeatable.",
    ),
]


def payloads_in(log: str, options: Sequence[str] | None) -> tuple[Payload, ...] | None:
    """Find the payloads of a log."""
    split = [_split(option) for option in options or ()]
    found = tuple(payload for name, payload in split if name is None or name in _names(log))
    return found or None


def refuse_other_payloads(options: Sequence[str] | None, logs: Sequence[str]) -> None:
    """Refuse payloads of logs that were not given."""
    known = {name for log in logs for name in _names(log)}
    for option in options or ():
        name, _ = _split(option)
        if name is not None and name not in known:
            raise ExoidError(f"--payload {option}: {name} is not among the logs", remedy="check its name")


def _names(log: str) -> tuple[str, ...]:
    """What an option may call a log."""
    return (log, Path(log).name)


def _split(option: str) -> tuple[str | None, Payload]:
    """Name of the log, and the payload."""
    name, found, text = option.rpartition("=")
    try:
        return (name if found else None), Payload.from_text(text)
    except ExoidError as error:
        raise ExoidError(f"--payload {option}: {error.what}", remedy=error.remedy or f"write {FORM}") from None
