"""Folders of text: written whole or not at all, and never over files of another origin."""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import shutil
from collections.abc import Mapping
from pathlib import Path

from exoid.errors import BadArgumentError
from exoid.tools.files import writing

MANIFEST = "exoid.json"
"""File with the hash of every other file, by which a folder is known as an earlier export."""


def write_folder(folder: str | os.PathLike[str], files: Mapping[str, str]) -> None:
    """Write files into a folder, complete or not at all; only an empty one or an unchanged export is replaced."""
    target = Path(os.path.realpath(folder))
    refuse_foreign(target)
    mark = secrets.token_hex(8)
    # beside the target, so that renaming stays within one file system
    part, before = (target.with_name(f".{target.name[:40]}.{mark}.{ending}") for ending in ("part", "before"))
    try:
        with writing(folder):
            hashes = {name: hashlib.sha256(text.encode()).hexdigest() for name, text in sorted(files.items())}
            manifest = json.dumps(hashes, indent=1)
            for name, text in {**files, MANIFEST: f"{manifest}\n"}.items():
                (part / name).parent.mkdir(parents=True, exist_ok=True)
                (part / name).write_text(text, encoding="utf-8", newline="\n")
            if target.exists():
                target.rename(before)
            try:
                part.rename(target)
            except BaseException:  # also when interrupted: the earlier export comes back
                if before.exists():
                    before.rename(target)
                raise
    finally:
        for each in (part, before):
            shutil.rmtree(each, ignore_errors=True)


def refuse_foreign(folder: str | os.PathLike[str]) -> None:
    """Refuse to replace a folder that has more in it than an unchanged earlier export."""
    target = Path(os.path.realpath(folder))
    if not target.parent.is_dir():
        raise BadArgumentError("there is no folder to write into", where=str(target.parent), remedy="make it first")
    if not target.exists():
        return
    if not target.is_dir():
        raise BadArgumentError("is no folder", where=str(folder), remedy="name a new folder")
    # a link counts as a file, also one to a folder
    paths = [path for path in target.rglob("*") if path.is_symlink() or not path.is_dir()]
    found, known = [path.relative_to(target).as_posix() for path in paths], _manifest(target)
    hashes = {name: hashlib.sha256((target / name).read_bytes()).hexdigest() for name in found if name != MANIFEST}
    others = sorted(name for name, sha256 in hashes.items() if known.get(name) != sha256)
    if MANIFEST in found and not known:
        others.append(MANIFEST)
    if others:
        names = ", ".join(others[:3]) + (f" and {len(others) - 3} more" if len(others) > 3 else "")
        raise BadArgumentError(
            f"the folder has files that exoid did not write, or that were changed: {names}",
            where=str(folder),
            remedy="name a new folder",
        )


def _manifest(folder: Path) -> dict[str, str]:
    """Hashes of an earlier export; empty if there was none."""
    try:
        found = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}
