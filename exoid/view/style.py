"""Style of all figures, sizes for a two-column paper, and their files."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.tools.files import make_folder, write_bytes

from .colours import GUIDE, PREDICTED

COLUMN, PAGE = 3.5, 7.2
"""Widths of one column (89 mm) and of two (183 mm) [inches]."""

SETTINGS: Any = {
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "legend.fontsize": 7,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "lines.linewidth": 1.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "figure.dpi": 200,
    "figure.constrained_layout.use": True,
    "pdf.fonttype": 42,  # TrueType: publishers refuse type 3, matplotlib's default
    "svg.hashsalt": "exoid",
}


def paper() -> AbstractContextManager[None]:
    """Use the style of a two-column paper inside a ``with`` block.

    Returns:
        Context manager that restores matplotlib's settings at the end.
    """
    return rc_context(SETTINGS)


def short_name(name: str) -> str:
    """Shorten the name of a sum to its first summand, which is unique; base parameters of arms have long names."""
    return name if len(name) <= 20 else f"{name.split(' ', maxsplit=1)[0]} …"


def legend_above(ax: Axes, columns: int = 3) -> None:
    """Put the legend above the axes, where it hides no data, in as many columns as fit beside the names of rows."""
    letter, rows = 0.06, [label.get_text() for label in ax.get_yticklabels()]  # width [inches] at 7 points
    room = ax.figure.bbox.width / ax.figure.dpi - letter * max((len(row) for row in rows), default=0)
    if labels := ax.get_legend_handles_labels()[1]:
        columns = max(1, min(columns, int(room / (0.4 + letter * max(map(len, labels))))))  # each with its handle
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.1, columnspacing=1.2)


def decorate(ax: Axes, xlabel: str, ylabel: str, *, zero: bool = False, columns: int = 3) -> Axes:
    """Name the axes, draw the zero line if it is wanted, and put the legend, if there is one, above."""
    if zero:
        ax.axhline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(xlabel=xlabel, ylabel=ylabel)
    legend_above(ax, columns)
    return ax


def decorate_column(axes: Sequence[Axes], ylabels: Sequence[str], columns: int = 3) -> Sequence[Axes]:
    """Name axes that stand one above the other and share their time; the first has the legend."""
    for ax, label in zip(axes, ylabels, strict=True):
        ax.set(ylabel=label)
    legend_above(axes[0], columns)
    axes[0].figure.align_ylabels(list(axes))
    axes[-1].set(xlabel="time [s]")
    return axes


def draw_band(ax: Axes, time: FloatArray, centre: FloatArray, half: FloatArray, colour: str = PREDICTED) -> None:
    """Draw the 95 % band around a line."""
    ax.fill_between(time, centre - half, centre + half, color=colour, alpha=0.3, lw=0, label="95 % band")


def decimation(count: int, most: int) -> slice:
    """Return the slice that decimates ``count`` samples to at most ``most``."""
    return slice(0, count, max(1, -(-count // most)))


def draw_samples(
    ax: Axes, x: FloatArray, y: FloatArray, colour: str, *, size: float, alpha: float = 0.5, label: str | None = None
) -> None:
    """Draw samples as dots, not more than a figure can show; the dot of the legend is larger."""
    shown = decimation(len(x), 4000)
    ax.plot(x[shown], y[shown], ".", ms=size, color=colour, alpha=alpha, rasterized=True)
    if label is not None:
        ax.plot([], [], ".", ms=5.0, color=colour, label=label)


def render(figure: Figure, file_format: str, **options: Any) -> bytes:  # noqa: ANN401 - those of savefig
    """Render a figure; the same figure gives the same bytes."""
    file = io.BytesIO()
    dated = {"pdf": "CreationDate", "svg": "Date"}.get(file_format)
    with paper():
        figure.savefig(file, format=file_format, metadata={dated: None} if dated else None, **options)
    return file.getvalue()


def write_figures(
    folder: str | Path, figures: Mapping[str, Figure], formats: Sequence[str] = ("pdf", "svg")
) -> list[Path]:
    """Write figures, each in all formats; all are rendered before the first is written.

    Args:
        folder: Folder; made if there is none.
        figures: Figures by name, such as those of a report.
        formats: Endings of the files, such as pdf, svg and png.

    Returns:
        The files.

    Raises:
        ExoidError: The folder cannot be written.
    """
    path = make_folder(folder)
    images = {path / f"{name}.{each}": render(figure, each) for name, figure in figures.items() for each in formats}
    for file, content in images.items():
        write_bytes(file, [content])
    return list(images)
