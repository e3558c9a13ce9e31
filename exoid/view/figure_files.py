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
    """Make the folder that figures are to be written to, before anything takes time.

    Raises:
        ExoidError: It cannot be made, or cannot be written into.
    """
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK | os.X_OK):
            raise PermissionError("no permission to write")
    except OSError as error:
        raise ExoidError(
            f"is no folder to write figures into ({error.strerror or error})",
            where=str(folder),
            remedy="name a new folder, or one that is yours",
        ) from None
    return path


def write_figures(figures: Mapping[str, Figure], folder: str | Path, form: str = "png") -> list[Path]:
    """Write figures, all of which are rendered before the first is written.

    Args:
        figures: By the name of their file.
        folder: Where to.
        form: "png" or "pdf".

    Raises:
        ExoidError: The folder cannot be made or written.
    """
    path, images = make_folder(folder), {}
    for name, figure in figures.items():
        image = io.BytesIO()
        with paper():
            figure.savefig(image, format=form)
        images[path / f"{name}.{form}"] = image.getvalue()
    for file, content in images.items():
        write_bytes(file, [content])
    return list(images)
