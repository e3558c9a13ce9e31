"""What a verb says on standard error beside its result: notes, and with ``--verbose`` what it reads."""

from __future__ import annotations

from contextvars import ContextVar
from enum import IntEnum

import typer


class Amount(IntEnum):
    """How much is said on standard error; errors always are."""

    # QUIET: Nothing.
    # USUAL: Files that were written, notes, and progress.
    # VERBOSE: Also what was read, and the seconds of each step.

    QUIET = 0
    USUAL = 1
    VERBOSE = 2


amount: ContextVar[Amount] = ContextVar("amount", default=Amount.USUAL)
"""How much this command says."""


def note(text: str, least: Amount = Amount.USUAL) -> None:
    """Write a line to standard error."""
    if amount.get() >= least:
        typer.echo(text, err=True)
