"""Atomic writing of one file or of several that belong together."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from .errors import ExoidError


def write_whole(path: str | os.PathLike[str], pieces: Iterable[str]) -> None:
    """Write text atomically: the file appears under its name only when it is complete.

    Args:
        path: File to write; an existing one is replaced.
        pieces: Text in pieces.

    Raises:
        ExoidError: The folder is missing or cannot be written, or the disk is full.
    """
    write_bytes(path, (piece.encode() for piece in pieces))


def write_together(contents: Mapping[Path, str]) -> None:
    """Write several texts atomically: either all files appear under their names or none does.

    Each text is first written to a temporary file in the same folder. Then all files are renamed. If a renaming fails,
    the earlier files are restored.

    Args:
        contents: Text of each file; existing files are replaced.

    Raises:
        ExoidError: A folder is missing or cannot be written, or the disk is full.
    """
    parts = {path: path.with_name(f".{path.name}.{os.getpid()}.part") for path in contents}
    saved = {path: path.with_name(f".{path.name}.{os.getpid()}.before") for path in contents}
    replaced: list[Path] = []
    placed: list[Path] = []
    try:
        for path, text in contents.items():
            try:
                write_whole(parts[path], [text])
            except ExoidError as error:
                raise ExoidError(error.what, where=str(path), remedy=error.remedy) from None
        for path in contents:
            with _written(path):
                if path.is_file():
                    shutil.copyfile(path, saved[path])  # a copy, so that at no moment there is no file of this name
                    replaced.append(path)
        for path in contents:
            with _written(path):
                parts[path].replace(path)
                placed.append(path)
    except BaseException:
        for path in placed:
            if path in replaced:
                saved[path].replace(path)
            else:
                path.unlink()
        raise
    finally:
        for path in (*parts.values(), *saved.values()):
            path.unlink(missing_ok=True)


def refuse_unwritable(path: str | os.PathLike[str]) -> None:
    """Check that a file can be written, before the work for its content begins.

    Args:
        path: The file.

    Raises:
        ExoidError: The folder is missing or cannot be written, or the path is a folder.
    """
    target = Path(path)
    with _written(path):
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, "it is a folder")
        if not target.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, "there is no such folder")
        if not os.access(target.parent, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "no permission to write")


def write_bytes(path: str | os.PathLike[str], pieces: Iterable[bytes]) -> None:
    """Write bytes atomically, see :func:`write_whole`.

    Args:
        path: File to write; an existing one is replaced.
        pieces: Bytes in pieces.

    Raises:
        ExoidError: The folder is missing or cannot be written, or the disk is full.
    """
    target = Path(path)
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    with _written(path):
        try:
            with part.open("xb") as file:
                file.writelines(pieces)
                file.flush()
                os.fsync(file.fileno())
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


@contextmanager
def _written(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn an error of the operating system into one line about a path."""
    try:
        yield
    except OSError as problem:
        raise ExoidError(
            f"cannot be written: {problem.strerror or problem}",
            where=str(path),
            remedy="write into an existing folder for which you have permission, on a disk with free space",
        ) from None
