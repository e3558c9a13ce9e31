"""Files of other people's data: found in ``$EXOID_DATA_DIR``, or downloaded once."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from exoid.errors import ExoidError


def find_or_download(url: str, sha256: str, file: str) -> Path:
    """Find a file in ``$EXOID_DATA_DIR`` or in the cache, or download it, and check its hash."""
    folder = os.environ.get("EXOID_DATA_DIR")
    kept = Path(folder or "") / file
    if folder and kept.is_file():
        if hashlib.sha256(kept.read_bytes()).hexdigest() != sha256:
            raise ExoidError(
                "not the published file: its hash differs", where=str(kept), remedy="delete it, or unset EXOID_DATA_DIR"
            )
        return kept
    import pooch  # noqa: PLC0415 - it is needed once, for the download

    try:
        return Path(pooch.retrieve(url, f"sha256:{sha256}", fname=Path(file).name, path=pooch.os_cache("exoid")))
    except Exception as error:  # pooch passes on any error of its downloader
        raise ExoidError(
            f"cannot be downloaded ({' '.join(str(error).split())[:200]})",
            where=url,
            remedy=f"download it to $EXOID_DATA_DIR/{file}",
        ) from error
