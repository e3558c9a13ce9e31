"""Style of all figures: sizes for a two-column paper."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes

from exoid._typing import FloatArray

COLUMN = 3.5
"""Width of a column [inches]."""

MAX_POINTS = 4000
"""Largest number of samples that a scatter plot draws."""

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
}


def paper() -> AbstractContextManager[None]:
    """Use the style of a two-column paper inside a ``with`` block.

    Returns:
        Context manager that restores matplotlib's settings at the end.
    """
    return rc_context(SETTINGS)


def legend_above(ax: Axes, columns: int = 3) -> None:
    """Put the legend above the axes, where it hides no data."""
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.1, columnspacing=1.2)


def decimation(count: int, most: int = MAX_POINTS) -> slice:
    """Return the slice that decimates ``count`` samples to at most ``most``."""
    return slice(0, count, max(1, -(-count // most)))


def draw_samples(
    ax: Axes, x: FloatArray, y: FloatArray, colour: str, *, size: float, alpha: float = 0.5, label: str | None = None
) -> None:
    """Draw samples as dots, decimated to :data:`MAX_POINTS`."""
    shown = decimation(len(x))
    ax.plot(x[shown], y[shown], ".", ms=size, color=colour, alpha=alpha, rasterized=True, label=label)
