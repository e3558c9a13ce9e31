"""Figures as files."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

from matplotlib.figure import Figure

from exoid.tools.files import make_folder, write_bytes

from .style import paper


def write_figures(folder: str | Path, figures: Mapping[str, Figure], file_format: str = "png") -> list[Path]:
    """Write figures; all are rendered before the first is written."""
    path, images = make_folder(folder), {}
    for name, figure in figures.items():
        image = io.BytesIO()
        with paper():
            figure.savefig(image, format=file_format)
        images[path / f"{name}.{file_format}"] = image.getvalue()
    for file, content in images.items():
        write_bytes(file, [content])
    return list(images)
