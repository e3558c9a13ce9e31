"""Finished chunks of a study on disk, from which a study that was killed is resumed."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np

from exoid.errors import BadArgumentError
from exoid.tools.files import write_bytes, write_whole

from .design import Study
from .replicates import Outcomes


class Folder:
    """A folder with ``study.json`` and a file for each finished chunk; each is written whole or not at all."""

    def __init__(self, path: Path, study: Study) -> None:
        """Open or make the folder."""
        self.path, self._study = path, study
        try:
            path.mkdir(parents=True, exist_ok=True)
            found = [file for file in path.iterdir() if not file.name.startswith(".")]  # others may be writing
        except OSError as error:
            raise BadArgumentError(
                f"is no folder for results ({error.strerror or error})", where=str(path), remedy="name a new folder"
            ) from None
        about = path / "study.json"
        if about.exists():  # checked after the chunks, because it is written before them
            try:
                known = json.loads(about.read_text(encoding="utf-8"))["sha256"]
            except (OSError, ValueError, KeyError, TypeError):
                known = ""
            if known != study.sha256:
                raise BadArgumentError(
                    "holds the results of another study",
                    where=str(path),
                    remedy="ask for the same leg, protocols, noise, estimators, replicates and seed, or name a new "
                    "folder",
                )
        elif found:
            raise BadArgumentError("holds other files", where=str(path), remedy="name a new folder for the results")
        else:
            described = {"sha256": study.sha256, **study.to_json()}
            write_whole(about, [json.dumps(described, indent=1, ensure_ascii=False), "\n"])

    def read(self, number: int) -> Outcomes | None:
        """Read a chunk."""
        study, replicates = self._study, self._study.chunks[number].replicates
        shape = (len(study.estimators), replicates, len(study.truth))
        try:
            with np.load(self._name(number), allow_pickle=False) as file:
                outcomes = Outcomes(**file)
            fits = all(array.shape == shape for array in outcomes)
            numbers = all(array.dtype.kind == kind for array, kind in zip(outcomes, "ffb", strict=True))
            return outcomes if fits and numbers and np.isfinite(outcomes.values).all() else None
        except Exception:  # a damaged archive raises errors of many kinds; the chunk is run again
            return None

    def write(self, number: int, outcomes: Outcomes) -> None:
        """Write a chunk."""
        content = io.BytesIO()
        np.savez(content, **outcomes._asdict())
        write_bytes(self._name(number), [content.getvalue()])

    def _name(self, number: int) -> Path:
        return self.path / f"piece-{number:05d}.npz"
