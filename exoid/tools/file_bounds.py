"""Bounds on what a file may hold, and errors of libraries that read files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from exoid.errors import ExoidError, UnreadableInputError

MOST_MEMORY = 2**26
"""Size of numbers in memory from which on the expansion of a file is checked [bytes]."""

READER_MEMORY = 2**26
"""Memory that a reader needs beside the content of the file [bytes]."""


def size_on_disk(path: Path) -> int:
    """Find the size of a file, or of the files in a folder."""
    files = path.iterdir() if path.is_dir() else (path,)
    return sum(file.stat().st_size for file in files if file.is_file())


def most_memory(size: int) -> int:
    """Largest plausible size of a file's numbers in memory."""
    return max(MOST_MEMORY, 50 * size)  # measurements contain noise: few compress by more than 10


def most_seconds(size: int) -> float:
    """Longest time that reading a file may take."""
    return 15.0 + size / 2e5  # start of a reader, and 0.2 MB/s: bags take longest


def refuse_expansion(memory: int, path: Path) -> None:
    """Refuse a file whose content is far larger than the file, which may be made to fill the memory."""
    size = size_on_disk(path)
    if memory > most_memory(size):
        what = f"{size} bytes would become {memory / 1e6:.0f} MB in memory, which is not plausible for measurements"
        remedy = "check where the file comes from; write it without compression if it is valid"
        raise UnreadableInputError(what, remedy=remedy)


@contextmanager
def reading(kind: str, remedy: str) -> Iterator[None]:
    """Turn any exception that a library raises on a damaged file into one line."""
    try:
        yield
    except (ExoidError, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except MemoryError:
        raise UnreadableInputError(f"too large for the memory, or damaged: not {kind}", remedy=remedy) from None
    except BaseException as problem:  # panics of polars are not of class Exception
        what = " ".join(str(problem).split())[:200] or type(problem).__name__
        raise UnreadableInputError(f"cannot be read as {kind}: {what}", remedy=remedy) from None
