"""Progress on standard error: a bar on a terminal, lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress

from .messages import Amount, amount, note

PATIENCE = 2.0
"""Time after which lines are written where standard error is no terminal [s]."""


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[[float], None]]:
    """Show progress: a bar on a terminal; elsewhere a line after each tenth, if it takes longer than 2 s."""
    console, begin = Console(stderr=True), time.monotonic()
    shown = console.is_terminal and amount.get() > Amount.QUIET
    with Progress(console=console, transient=True, disable=not shown) as bar:
        task = bar.add_task(label, total=1.0)
        yield (lambda share: bar.update(task, completed=share)) if shown else _tenths(label, begin)
    note(f"{label}: {time.monotonic() - begin:.1f} s", Amount.VERBOSE)


@contextmanager
def status(label: str) -> Iterator[None]:
    """Show on a terminal what a command is doing."""
    begin = time.monotonic()
    console = Console(stderr=True, quiet=amount.get() == Amount.QUIET)
    with console.status(label):
        yield
    note(f"{label}: {time.monotonic() - begin:.1f} s", Amount.VERBOSE)


def _tenths(label: str, begin: float) -> Callable[[float], None]:
    """Write a line to standard error after each tenth."""
    done = 0

    def report(share: float) -> None:
        """Write the line of a tenth that is new."""
        nonlocal done
        tenths = min(10, int(10.0 * share + 1e-9))
        if tenths > done and time.monotonic() - begin > PATIENCE:
            done = tenths
            note(f"{label}: {10 * tenths} %")

    return report
