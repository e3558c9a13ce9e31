"""Finished chunks of a study, kept so that a study that was killed goes on where it stopped."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import numpy as np

from exoid.errors import ExoidError
from exoid.files import write_bytes, write_whole

from .design import Study
from .driving import MEASURES
from .replicates import Outcomes

ABOUT = "study.json"


class Folder:
    """A folder with ``study.json`` and a file for each finished chunk; each is written whole or not at all."""

    def __init__(self, path: Path, study: Study) -> None:
        """Open it, or make it.

        Raises:
            ExoidError: It holds another study, or cannot be made.
        """
        self.path, self._study = path, study
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ExoidError(
                f"is no folder for results ({error.strerror or error})", where=str(path), remedy="name a new folder"
            ) from None
        about = path / ABOUT
        found = [file for file in path.iterdir() if not file.name.startswith(".")]  # others may be writing
        if about.exists():  # looked for after the chunks, before which it is written
            self._refuse_another(about)
        elif found:
            raise ExoidError("holds other files", where=str(path), remedy="name a new folder for the results")
        else:
            described = {"sha256": study.sha256, **study.to_json()}
            write_whole(about, [json.dumps(described, indent=1, ensure_ascii=False), "\n"])

    def read(self, number: int) -> Outcomes | None:
        """Read a chunk; None if it is not there, or damaged and so to be done again."""
        try:
            with np.load(self._name(number), allow_pickle=False) as file:
                outcomes = Outcomes(file["values"], file["std"], file["inside"], file["driven"])
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        study, replicates = self._study, self._study.chunks[number].replicates
        shape = (len(study.estimators), replicates, len(study.truth))
        driven = (len(study.drivers), replicates, len(MEASURES), len(study.leg.joints))
        fits = all(array.shape == shape for array in outcomes[:3]) and outcomes.driven.shape == driven
        return outcomes if fits and np.isfinite(outcomes.values).all() else None

    def write(self, number: int, outcomes: Outcomes) -> None:
        """Keep a chunk.

        Raises:
            ExoidError: It cannot be written.
        """
        content = io.BytesIO()
        np.savez(content, **outcomes._asdict())
        write_bytes(self._name(number), [content.getvalue()])

    def _name(self, number: int) -> Path:
        return self.path / f"piece-{number:05d}.npz"

    def _refuse_another(self, about: Path) -> None:
        try:
            known = json.loads(about.read_text(encoding="utf-8"))["sha256"]
        except (OSError, ValueError, KeyError, TypeError):
            known = ""
        if known != self._study.sha256:
            raise ExoidError(
                "holds the results of another study",
                where=str(self.path),
                remedy="ask for the same leg, protocols, noise, estimators, replicates and seed, or name a new folder",
            )
