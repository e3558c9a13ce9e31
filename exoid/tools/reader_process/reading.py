"""Errors of libraries that read files, in one line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from exoid.errors import ExoidError


@contextmanager
def reading(file: str, kind: str, remedy: str) -> Iterator[None]:
    """Turn any exception that a library raises on a damaged file into one line."""
    try:
        yield
    except (ExoidError, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except MemoryError:
        raise ExoidError(f"too large for the memory, or a damaged {kind}", where=file, remedy=remedy) from None
    except BaseException as problem:  # panics of polars are not of class Exception
        what = " ".join(str(problem).split())[:200] or type(problem).__name__
        raise ExoidError(f"cannot be read as {kind}: {what}", where=file, remedy=remedy) from None
