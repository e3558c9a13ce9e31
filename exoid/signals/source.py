"""Evidence of where data came from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Source:
    """The file some data were read from.

    Attributes:
        name: Name of the file, without its folder.
        sha256: SHA-256 of the bytes that were read, as 64 hexadecimal digits.
    """

    name: str
    sha256: str
