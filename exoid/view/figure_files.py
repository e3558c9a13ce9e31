"""Figures as files."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from pathlib import Path

from matplotlib.figure import Figure

from exoid.errors import ExoidError
from exoid.files import write_bytes

from .style import paper


def make_folder(folder: str | Path) -> Path:
    """Make the folder for figures, before a computation that takes time.

    Args:
        folder: Path of the folder; its parents are made too.

    Returns:
        Path of the folder.

    Raises:
        ExoidError: The folder cannot be made, or is not writable.
    """
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK | os.X_OK):
            raise PermissionError("no permission to write")
    except OSError as error:
        raise ExoidError(
            f"cannot write figures into this folder ({error.strerror or error})",
            where=str(folder),
            remedy="name a new folder, or one with write permission",
        ) from None
    return path


def write_figures(folder: str | Path, figures: Mapping[str, Figure], file_format: str = "png") -> list[Path]:
    """Write figures; all are rendered before the first is written.

    Args:
        folder: Path of the folder; made if it does not exist.
        figures: Figures by file name without ending.
        file_format: "png" or "pdf".

    Returns:
        Paths of the files.

    Raises:
        ExoidError: The folder cannot be made, or a file cannot be written.
    """
    path, images = make_folder(folder), {}
    for name, figure in figures.items():
        image = io.BytesIO()
        with paper():
            figure.savefig(image, format=file_format)
        images[path / f"{name}.{file_format}"] = image.getvalue()
    for file, content in images.items():
        write_bytes(file, [content])
    return list(images)
