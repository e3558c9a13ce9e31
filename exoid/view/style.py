"""How figures look: colours that a colour-blind reader tells apart, sizes for a two-column paper."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes

COLUMN = 3.5
"""Width of a column [inches]."""

MEASURED, IDENTIFIED, CAD, LEFT_OVER, GUIDE = "#222222", "#0072B2", "#D55E00", "#999999", "#cccccc"
"""Of what was measured, what an identified model says, what CAD says, residuals, and lines that guide the eye."""

JOINT_COLOURS = ("#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00", "#7F7F7F")
"""Hip, knee, ankle, and the further joints of an arm."""

SHADES = ("#9ecae1", "#4292c6", "#08519c", "#08306b")
"""Of several sets of the same, from light to dark."""

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
    """Use these settings inside a ``with``."""
    return rc_context(SETTINGS)


def legend_above(ax: Axes, columns: int = 3) -> None:
    """Put the legend above the axes, where it hides no data."""
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.1, columnspacing=1.2)


def joint_colour(joint: int) -> str:
    """Colour of a joint, the same in every figure."""
    return JOINT_COLOURS[joint % len(JOINT_COLOURS)]
