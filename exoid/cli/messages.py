"""What a verb says on standard error beside its result, unless the command is to be quiet: notes, and progress."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import typer

quiet: ContextVar[bool] = ContextVar("quiet", default=False)
"""Whether only errors are said."""


def note(text: str) -> None:
    """Write a line to standard error."""
    if not quiet.get():
        typer.echo(text, err=True)


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal."""
    from rich.console import Console  # noqa: PLC0415 - help needs no bars
    from rich.progress import Progress  # noqa: PLC0415

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=quiet.get() or not console.is_terminal) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda share: bar.update(task, completed=share)


@contextmanager
def status(label: str) -> Iterator[None]:
    """Show on a terminal what a command is doing."""
    from rich.console import Console  # noqa: PLC0415 - see above

    with Console(stderr=True, quiet=quiet.get()).status(label):
        yield
