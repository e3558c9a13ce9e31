"""Example data of one leg, whose files are found in ``$EXOID_DATA_DIR`` or downloaded once."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from exoid.errors import UnreadableInputError
from exoid.leg.leg import Leg
from exoid.signals.recording import Recording


@dataclass(frozen=True, eq=False)
class Dataset:
    """Leg with recordings for identification and validation.

    Attributes:
        leg: The leg.
        train: Recording for identification.
        test: Recording for validation.
        citation: Source of the data, and their licence.
    """

    leg: Leg
    train: Recording
    test: Recording
    citation: str


def find_or_download(url: str, sha256: str, file: str) -> Path:
    """Find a file in ``$EXOID_DATA_DIR`` or in the cache, or download it, and check its hash."""
    folder = os.environ.get("EXOID_DATA_DIR")
    kept = Path(folder or "") / file
    if folder and kept.is_file():
        if hashlib.sha256(kept.read_bytes()).hexdigest() != sha256:
            raise UnreadableInputError(
                "not the published file: its hash differs", where=str(kept), remedy="delete it, or unset EXOID_DATA_DIR"
            )
        return kept
    import pooch  # noqa: PLC0415 - it is needed once, for the download

    try:
        return Path(pooch.retrieve(url, f"sha256:{sha256}", fname=Path(file).name, path=pooch.os_cache("exoid")))
    except Exception as error:  # pooch passes on any error of its downloader
        raise UnreadableInputError(
            f"cannot be downloaded ({' '.join(str(error).split())[:200]})",
            where=url,
            remedy=f"download it to $EXOID_DATA_DIR/{file}",
        ) from error
