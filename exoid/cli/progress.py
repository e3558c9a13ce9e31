"""Progress on standard error, where it is a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress

from .messages import quiet


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal."""
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=quiet.get() or not console.is_terminal) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda share: bar.update(task, completed=share)


@contextmanager
def status(label: str) -> Iterator[None]:
    """Show on a terminal what a command is doing."""
    with Console(stderr=True, quiet=quiet.get()).status(label):
        yield
