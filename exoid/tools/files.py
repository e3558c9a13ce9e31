"""Input files of a bounded size. Output files: checked before the work, written atomically, never over an input.

A file appears under its name only when it is complete. A symbolic link stays, and the file that it names is written. A
file that is replaced keeps its mode and, where the system allows it, its owner. Devices, pipes and sockets are refused.
"""

from __future__ import annotations

import codecs
import errno
import glob
import hashlib
import json
import os
import secrets
import shutil
import stat
import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from exoid.errors import BadArgumentError, ExoidError, UnreadableInputError

STANDARD_OUTPUT = 1
"""Number of the file in which the output of the process goes."""

REPLACES = "is an input, which the output would replace"


def read_bounded(path: str | os.PathLike[str], largest: int, remedy: str) -> bytes:
    """Read a regular file of at most so many bytes: devices and pipes have no end."""
    try:
        mode = os.stat(path).st_mode  # noqa: PTH116 - a path with a null byte is a ValueError
        if not stat.S_ISREG(mode):
            what = "is a directory" if stat.S_ISDIR(mode) else "is a device or a pipe"
            raise UnreadableInputError(what, file=str(path), remedy=remedy)
        with Path(path).open("rb") as opened:
            content = opened.read(largest + 1)
    except (OSError, TypeError, ValueError) as error:
        what = f"cannot be read ({getattr(error, 'strerror', None) or error})"
        raise UnreadableInputError(what, file=str(path), remedy=remedy) from error
    if len(content) > largest:
        raise UnreadableInputError(f"larger than {largest / 1e6:.3g} MB", file=str(path), remedy=remedy)
    return content


def read_json(path: str | os.PathLike[str], what: str, schema: str, remedy: str) -> dict[str, Any]:
    """Read a file of a schema that exoid wrote."""
    try:
        data = json.loads(read_bounded(path, 2**26, remedy).decode("utf-8"))  # exoid writes no longer one
    except (ValueError, RecursionError) as error:  # not UTF-8, not JSON, a number of ten thousand digits
        raise UnreadableInputError(f"no {what}: not JSON ({error})", file=str(path), remedy=remedy) from error
    if not isinstance(data, dict) or data.get("schema") != schema:
        raise UnreadableInputError(f"no {what} of schema {schema!r}", file=str(path), remedy=remedy)
    return data


def write_whole(path: str | os.PathLike[str], pieces: Iterable[str]) -> None:
    """Write text atomically: the file appears under its name only when it is complete."""
    write_bytes(path, (piece.encode() for piece in pieces))


def write_bytes(path: str | os.PathLike[str], pieces: Iterable[bytes]) -> None:
    """Write bytes atomically, see :func:`write_whole`."""
    with writing(path):
        target = _target(path)
        part = _beside(target, "part")
        try:
            _write_part(part, target, pieces)
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


def write_together(contents: Mapping[Path, str]) -> None:
    """Write several texts atomically: either all files appear under their names or none does."""
    # Each text is first written to a temporary file in the same folder. Then all files are renamed. If a
    # renaming fails, the earlier files are restored.
    targets: dict[Path, Path] = {}
    for path in contents:
        with writing(path):
            targets[path] = _target(path)
    parts = {path: _beside(target, "part") for path, target in targets.items()}
    saved = {path: _beside(target, "before") for path, target in targets.items()}
    replaced: list[Path] = []
    placed: list[Path] = []
    try:
        for path, text in contents.items():
            with writing(path):
                _write_part(parts[path], targets[path], [text.encode()])
        for path, target in targets.items():
            with writing(path):
                if target.is_file():
                    shutil.copy2(target, saved[path])  # a copy, so that at no moment there is no file of this name
                    replaced.append(path)
        for path, target in targets.items():
            with writing(path):
                parts[path].replace(target)
                placed.append(path)
    except BaseException:
        for path in placed:
            if path in replaced:
                saved[path].replace(targets[path])
            else:
                targets[path].unlink()
        raise
    finally:
        for path in (*parts.values(), *saved.values()):
            path.unlink(missing_ok=True)


def refuse_unwritable(path: str | os.PathLike[str]) -> None:
    """Check that a file can be written, before the work for its content begins."""
    with writing(path):
        part = _beside(_target(path), "part")
        try:
            part.touch(exist_ok=False)
        finally:
            part.unlink(missing_ok=True)


def refuse_input(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]]) -> None:
    """Refuse to write a file that is read, or that lies in a folder that is read."""
    if not os.path.exists(path):  # noqa: PTH110 - False, not an error, below a folder that cannot be read
        return
    target = Path(path)
    for name in inputs:
        source, reads = Path(name), False
        with suppress(OSError, ValueError):  # not a file, such as the name of a leg; or reading it has a better message
            inside = source.is_dir() and any(parent.samefile(source) for parent in target.resolve().parents)
            reads = inside or source.samefile(target)
        if reads:
            raise BadArgumentError(
                f"is an input ({name}), which the output would replace" if str(name) != str(path) else REPLACES,
                where=str(path),
                remedy="give the output another name",
            )


def refuse_content(path: str | os.PathLike[str], sha256: Collection[str]) -> None:
    """Refuse to write a file whose present content is an input of the result."""
    with writing(path):
        target = Path(path)
        if not sha256 or not target.is_file():
            return
        content = target.read_bytes()
        found = {hashlib.sha256(each).hexdigest() for each in (content, content.removeprefix(codecs.BOM_UTF8))}
    if not found.isdisjoint(sha256):
        raise BadArgumentError(REPLACES, where=str(path), remedy="give the output another name")


def make_folder(folder: str | os.PathLike[str]) -> Path:
    """Make a folder for files, before the work for their content begins."""
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
        refuse_unwritable(path / "file")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
    except ExoidError as error:
        reason = error.what
    else:
        return path
    what, remedy = f"cannot write files into this folder ({reason})", "name a new folder, or one with write permission"
    raise BadArgumentError(what, where=str(folder), remedy=remedy)


def _target(path: str | os.PathLike[str]) -> Path:
    """Follow symbolic links to the file to write; raise OSError if no regular file can stand there."""
    target = Path(os.path.realpath(path, strict=False))
    if target.is_symlink():
        raise OSError(errno.ELOOP, "its links lead in a circle")
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "it is a folder")
    if target.exists():
        if _is_standard_output(target):
            raise OSError(errno.EINVAL, "it is the standard output, which the printed result needs")
        if not target.is_file():
            raise OSError(errno.EINVAL, "it is a device or a pipe, not a file")
        if not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, "it is write-protected")
    elif not target.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "there is no such folder")
    return target


def _is_standard_output(target: Path) -> bool:
    """Tell whether a file is where standard output goes: it would lose what is printed."""
    try:
        return os.path.samestat(target.stat(), os.fstat(STANDARD_OUTPUT))
    except OSError:  # there is no standard output
        return False


def _beside(target: Path, ending: str) -> Path:
    """Make a new hidden name in the same folder, and remove such parts of the file that a killed process left."""
    start = f".{target.name[:40]}."  # names have at most 255 bytes
    for part in target.parent.glob(f"{glob.escape(start)}{'[0-9a-f]' * 16}.part"):
        with suppress(OSError):
            if time.time() - part.stat().st_mtime > 3600.0:  # nobody writes at a file for an hour
                part.unlink()
    return target.with_name(f"{start}{secrets.token_hex(8)}.{ending}")


def _write_part(part: Path, target: Path, pieces: Iterable[bytes]) -> None:
    """Write a temporary file with the mode and the owner of the file that it will replace."""
    with part.open("xb") as file:
        file.writelines(pieces)
        file.flush()
        os.fsync(file.fileno())
    if target.exists():
        before = target.stat()
        if hasattr(os, "chown"):
            with suppress(OSError):  # only root may give files away
                os.chown(part, before.st_uid, before.st_gid)
        part.chmod(stat.S_IMODE(before.st_mode))


@contextmanager
def writing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn an error of the operating system into one line about a path."""
    try:
        yield
    except OSError as problem:
        raise BadArgumentError(
            f"cannot be written: {problem.strerror or problem}",
            where=str(path),
            remedy="write into an existing folder for which you have permission, on a disk with free space",
        ) from None
    except (TypeError, ValueError) as problem:  # a null byte in the name, or no name
        raise BadArgumentError(f"cannot be written: {problem}", where=repr(path), remedy="give another name") from None
