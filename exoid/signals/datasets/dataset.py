"""Example data of one leg: part of the package, or found in ``$EXOID_DATA_DIR``, or downloaded once."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from exoid.errors import UnreadableInputError
from exoid.leg.catalog import load_leg
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


class PublishedFile(NamedTuple):
    """File of a dataset that is published elsewhere."""

    url: str
    sha256: str
    file: str  # its name in ``$EXOID_DATA_DIR``, with the folder of the dataset

    def path(self) -> Path:
        """Find the file in ``$EXOID_DATA_DIR`` or in the cache, or download it, and check its hash."""
        folder = os.environ.get("EXOID_DATA_DIR")
        kept = Path(folder or "") / self.file
        if folder and kept.is_file():
            if hashlib.sha256(kept.read_bytes()).hexdigest() != self.sha256:
                raise UnreadableInputError(
                    "not the published file: its hash differs",
                    where=str(kept),
                    remedy="delete it, or unset EXOID_DATA_DIR",
                )
            return kept
        import pooch  # noqa: PLC0415 - it is needed once, for the download

        cache = pooch.os_cache("exoid")
        try:
            return Path(pooch.retrieve(self.url, f"sha256:{self.sha256}", fname=kept.name, path=cache))
        except Exception as error:  # pooch passes on any error of its downloader
            raise UnreadableInputError(
                f"cannot be downloaded ({' '.join(str(error).split())[:200]})",
                where=self.url,
                remedy=f"download it to $EXOID_DATA_DIR/{self.file}",
            ) from error


def bleex_swing() -> Dataset:
    """Load encoder angles and noisy torques of a virtual BLEEX leg, the left one, at 100 Hz, 30 s and 15 s.

    ``scripts/make_bleex_swing.py`` wrote the files.

    Returns:
        Leg with CAD inertias, which differ from the simulated ones, a recording for identification and one for
        validation.
    """
    folder = Path(__file__).resolve().parent
    leg = load_leg("bleex", side="left", inertias="cad")
    train, test = (
        Recording.from_csv(folder / name, leg.joint_names) for name in ("bleex_swing.csv", "bleex_swing_test.csv")
    )
    citation = "simulated by exoid: BLEEX left leg, Tables II-IV of document 1, with assumed sensor noise"
    return Dataset(leg, train, test, citation)
