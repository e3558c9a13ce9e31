"""Writing files whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from .errors import ExoidError


def write_whole(path: str | os.PathLike[str], pieces: Iterable[str]) -> None:
    """Write text so that the file appears under its name only when it is complete.

    Args:
        path: File to write; an existing one is replaced.
        pieces: The text, piece by piece.

    Raises:
        ExoidError: The folder is missing or cannot be written, or the disk is full.
    """
    write_bytes(path, (piece.encode() for piece in pieces))


def write_bytes(path: str | os.PathLike[str], pieces: Iterable[bytes]) -> None:
    """Write bytes so that the file appears under its name only when it is complete; see :func:`write_whole`."""
    target = Path(path)
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        try:
            with part.open("xb") as file:
                file.writelines(pieces)
                file.flush()
                os.fsync(file.fileno())
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)
    except OSError as problem:
        raise ExoidError(
            f"cannot be written: {problem.strerror or problem}",
            where=str(path),
            remedy="write into an existing folder that is yours, on a disk with room",
        ) from None
