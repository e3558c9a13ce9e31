"""Figures of identified parameters and their uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap

from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.tables import with_error

from .colours import CAD, GUIDE, IDENTIFIED, LEFT_OVER, MEASURED
from .style import legend_above

MARKERS = ("D", "s", "^", "v")
"""Of values that stand beside the estimate."""

BESIDE = (CAD, MEASURED, LEFT_OVER)
"""Their colours."""

DIVERGING = LinearSegmentedColormap.from_list("exoid", [CAD, "#ffffff", IDENTIFIED])
"""From −1 through 0 to 1, in colours that a colour-blind reader tells apart."""

LONGEST = 20
"""Letters of a name beside an axis."""


def plot_parameters(
    ax: Axes,
    estimate: Estimate,
    names: Sequence[str] | None = None,
    beside: Mapping[str, Mapping[str, float]] | None = None,
    level: float = 0.95,
) -> Axes:
    """Parameters of one unit with their confidence intervals and standard deviations, and other values of them beside.

    Args:
        ax: Where to draw.
        estimate: The estimate.
        names: Which parameters, all of one unit; None for all of the unit of the first.
        beside: Values by name of, for example, CAD or the documents' tables; parameters they lack are left out.
        level: Probability that an interval contains the true value.

    Raises:
        ExoidError: A name is unknown, or units differ.
    """
    units = dict(zip(estimate.names, estimate.units, strict=True))
    chosen = [name for name in units if units[name] == estimate.units[0]] if names is None else list(names)
    for name in chosen:
        estimate.value(name)  # refuses what is unknown
    if len({units[name] for name in chosen}) != 1:
        raise ExoidError("parameters of several units do not share an axis", remedy="draw those of one unit at a time")
    index = [estimate.names.index(name) for name in chosen]
    rows, values, intervals = np.arange(len(chosen)), estimate.values[index], estimate.interval(level)[index]
    ax.errorbar(
        values,
        rows,
        xerr=np.abs(intervals.T - values),
        fmt="o",
        ms=3.5,
        capsize=2.5,
        color=IDENTIFIED,
        label=f"identified, {100 * level:.0f} %",
        zorder=3,
    )
    for (label, others), marker, colour in zip((beside or {}).items(), MARKERS, BESIDE, strict=False):
        known = [(others[name], row) for name, row in zip(chosen, rows, strict=True) if name in others]
        if known:
            ax.plot(*zip(*known, strict=True), marker, ms=4, mfc="none", color=colour, label=label)
    for row, k in zip(rows, index, strict=True):
        exact = estimate.std[k] == 0.0
        text = f"{estimate.values[k]:.6g}" if exact else " ± ".join(with_error(estimate.values[k], estimate.std[k]))
        text = text.replace("-", "−")
        ax.annotate(text, (1.02, row), xycoords=("axes fraction", "data"), va="center", fontsize=6)
    ax.axvline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(
        yticks=rows,
        yticklabels=[_short(name) for name in chosen],
        xlabel=f"[{units[chosen[0]]}]",
        ylim=(len(chosen) - 0.5, -0.5),
    )
    ax.grid(visible=False, axis="y")
    legend_above(ax)
    return ax


def plot_correlation(ax: Axes, estimate: Estimate) -> Axes:
    """Correlation of the errors of any two parameters: pairs near ±1 trade against each other.

    Args:
        ax: Where to draw.
        estimate: The estimate.
    """
    names, correlation = [_short(name) for name in estimate.names], estimate.correlation
    image = ax.imshow(correlation, cmap=DIVERGING, vmin=-1.0, vmax=1.0)
    size = max(2.5, min(6.0, 90.0 / len(names)))
    ax.set_xticks(range(len(names)), names, rotation=90, fontsize=size)
    ax.set_yticks(range(len(names)), names, fontsize=size)
    ax.grid(visible=False)
    ax.figure.colorbar(image, ax=ax, shrink=0.8, label="correlation [–]")
    return ax


def _short(name: str) -> str:
    """Name a sum by its first summand, which no other has: those of arms are long."""
    return name if len(name) <= LONGEST else f"{name.split(' ', maxsplit=1)[0]} + …"
