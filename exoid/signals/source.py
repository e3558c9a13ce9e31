"""Source of data: file name and hash."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Source:
    """File that data were read from.

    Attributes:
        name: Name of the file, without its folder.
        sha256: SHA-256 of the bytes that were read, as 64 hexadecimal digits. For a folder (rosbag2) it is the hash of
            the list that ``sha256sum *`` prints there.
    """

    name: str
    sha256: str

    def __post_init__(self) -> None:
        """Make the name text: bytes that are not UTF-8 are written as backslash, x and two digits."""
        name = os.fsencode(self.name).decode("utf-8", "backslashreplace")
        object.__setattr__(self, "name", name)

    @staticmethod
    def of(path: Path) -> Source:
        """Hash a file, or a folder of files, without holding it in memory.

        Args:
            path: The file or folder.

        Returns:
            Its name and hash.

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
        while chunk := file.read(2**20):
            digest.update(chunk)
    return digest.hexdigest()
