"""Evidence of where data came from."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

PIECE = 2**20
"""Bytes of a file read at once."""


@dataclass(frozen=True)
class Source:
    """The file some data were read from.

    Attributes:
        name: Name of the file, without its folder.
        sha256: SHA-256 of the bytes that were read, as 64 hexadecimal digits. Of a folder (rosbag2), that of the list
            which ``sha256sum *`` prints there.
    """

    name: str
    sha256: str

    @staticmethod
    def of(path: Path) -> Source:
        """Take the evidence of a file, or of a folder of files, without holding it in memory.

        Raises:
            OSError: It cannot be read.
        """
        name = path.name or path.resolve().name
        if not path.is_dir():
            return Source(name, _digest(path))
        files = sorted((file for file in path.iterdir() if file.is_file()), key=lambda file: file.name)
        listed = "".join(f"{_digest(file)}  {file.name}\n" for file in files)
        return Source(name, hashlib.sha256(listed.encode(errors="surrogateescape")).hexdigest())


def _digest(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while piece := file.read(PIECE):
            digest.update(piece)
    return digest.hexdigest()
