"""Folders of text: written whole or not at all, and never over files of another origin."""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import shutil
from collections.abc import Mapping
from pathlib import Path

from exoid.errors import ExoidError

MANIFEST = "exoid.json"
"""File with the hash of every other file, by which a folder is known as an earlier export."""


def write_folder(folder: str | os.PathLike[str], files: Mapping[str, str]) -> None:
    """Write files into a new folder, which appears under its name only when it is complete.

    An empty folder, and one that an earlier call wrote and nobody changed, are replaced.

    Args:
        folder: The folder; its parent exists.
        files: Text of each file by its path inside the folder.

    Raises:
        ExoidError: The folder has files of another origin or changed ones, or it cannot be written.
    """
    target = Path(os.path.realpath(folder))
    refuse_foreign(target)
    mark = secrets.token_hex(8)
    part, before = (target.with_name(f".{target.name[:40]}.{mark}.{ending}") for ending in ("part", "before"))
    try:
        _fill(part, files)
        if target.exists():
            target.rename(before)
        try:
            part.rename(target)
        except BaseException:
            if before.exists():
                before.rename(target)
            raise
    except OSError as problem:
        raise ExoidError(
            f"cannot be written: {problem.strerror or problem}",
            where=str(folder),
            remedy="name a new folder beside which you may write",
        ) from None
    finally:
        for each in (part, before):
            shutil.rmtree(each, ignore_errors=True)


def refuse_foreign(folder: str | os.PathLike[str]) -> None:
    """Refuse to replace a folder that has more in it than an unchanged earlier export.

    Args:
        folder: The folder.

    Raises:
        ExoidError: It is a file, its parent is missing, or it has files of another origin or changed ones.
    """
    target = Path(os.path.realpath(folder))
    if not target.parent.is_dir():
        raise ExoidError("there is no folder to write into", where=str(target.parent), remedy="make it first")
    if not target.exists():
        return
    found = _files(target)
    if found is None:
        raise ExoidError("is no folder", where=str(folder), remedy="name a new folder")
    known = _manifest(target)
    others = sorted(
        name for name in found if name != MANIFEST and known.get(name) != _hash((target / name).read_bytes())
    )
    if MANIFEST in found and not known:
        others.append(MANIFEST)
    if others:
        names = ", ".join(others[:3]) + (f" and {len(others) - 3} more" if len(others) > 3 else "")
        raise ExoidError(
            f"the folder has files that exoid did not write, or that were changed: {names}",
            where=str(folder),
            remedy="name a new folder",
        )


def _fill(part: Path, files: Mapping[str, str]) -> None:
    """Write all files, and their hashes."""
    manifest = json.dumps({name: _hash(text.encode()) for name, text in sorted(files.items())}, indent=1)
    for name, text in {**files, MANIFEST: f"{manifest}\n"}.items():
        path = part / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")


def _files(folder: Path) -> list[str] | None:
    """Paths of all files inside a folder; None if it is none. Links count as files."""
    if not folder.is_dir():
        return None
    return [path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_symlink() or not path.is_dir()]


def _manifest(folder: Path) -> dict[str, str]:
    """Hashes of an earlier export; empty if there was none."""
    try:
        found = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
