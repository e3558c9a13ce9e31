"""What a verb says on standard error beside its result: notes, unless the command is to be quiet."""

from __future__ import annotations

from contextvars import ContextVar

import typer

quiet: ContextVar[bool] = ContextVar("quiet", default=False)
"""Whether only errors are said."""


def note(text: str) -> None:
    """Write a line to standard error."""
    if not quiet.get():
        typer.echo(text, err=True)
