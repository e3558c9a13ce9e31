"""Names of joints, tables and files in errors about drives."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from exoid.errors import ExoidError


@contextmanager
def within(part: str) -> Iterator[None]:
    """Name a joint, table or file in errors that are raised inside."""
    try:
        yield
    except ExoidError as error:
        raise error.within(part) from error
