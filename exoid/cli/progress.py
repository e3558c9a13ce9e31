"""Progress bars on standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer
from rich.console import Console
from rich.progress import Progress


@contextmanager
def progress_bar(label: str, *, lines: bool = False) -> Iterator[Callable[[float], None]]:
    """Show a progress bar while a command runs.

    Args:
        label: Text beside the bar.
        lines: Whether to write a line after each tenth where standard error is no terminal; else nothing there.

    Yields:
        Function that receives the completed share, 0 to 1.
    """
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(label, total=1.0)
        if lines and not console.is_terminal:
            yield _tenths(label)
        else:
            yield lambda share: bar.update(task, completed=share)


def _tenths(label: str) -> Callable[[float], None]:
    """Write a line to standard error after each tenth."""
    done = 0

    def report(share: float) -> None:
        nonlocal done
        tenths = min(10, int(10.0 * share + 1e-9))
        if tenths > done:
            done = tenths
            typer.echo(f"{label}: {10 * tenths} %", err=True)

    return report
