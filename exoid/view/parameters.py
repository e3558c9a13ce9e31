"""Figures of identified parameters and their uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap

from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.tools.tables import with_error

from .colours import CAD, GUIDE, IDENTIFIED, MEASURED, RESIDUAL
from .style import legend_above

MARKERS = (("D", CAD), ("s", MEASURED), ("^", RESIDUAL))
"""Marker and colour of each set of other values."""

DIVERGING = LinearSegmentedColormap.from_list("exoid", ["#8C510A", "#FFFFFF", "#01665E"])
"""Colours from −1 (brown) through 0 to 1 (green) that colour-blind readers can distinguish."""


def plot_parameters(
    ax: Axes,
    estimate: Estimate,
    names: Sequence[str] | None = None,
    other_values: Mapping[str, Mapping[str, float]] | None = None,
    level: float = 0.95,
) -> Axes:
    """Plot parameters of one unit with confidence intervals and standard deviations, and other values to compare.

    Args:
        ax: Axes to draw on.
        estimate: The estimate.
        names: Names of the parameters, all of one unit; None for all parameters that have the unit of the first.
        other_values: Values by parameter name, by label, for example of CAD; missing parameters are not drawn.
        level: Confidence level of the intervals.

    Returns:
        The axes.

    Raises:
        ExoidError: A name is unknown, or the units differ.
    """
    units = dict(zip(estimate.names, estimate.units, strict=True))
    chosen = [name for name in units if units[name] == estimate.units[0]] if names is None else list(names)
    for name in chosen:
        estimate.value(name)  # raises an error if the name is unknown
    if len({units[name] for name in chosen}) != 1:
        raise BadArgumentError(
            "parameters of several units do not share an axis", remedy="draw those of one unit at a time"
        )
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
    for (label, others), (marker, colour) in zip((other_values or {}).items(), MARKERS, strict=False):
        present = [(others[name], row) for name, row in zip(chosen, rows, strict=True) if name in others]
        if present:
            ax.plot(*zip(*present, strict=True), marker, ms=4, mfc="none", color=colour, label=label)
    for row, k in zip(rows, index, strict=True):
        exact = estimate.std[k] == 0.0
        text = f"{estimate.values[k]:.6g}" if exact else " ± ".join(with_error(estimate.values[k], estimate.std[k]))
        text = text.replace("-", "−")
        ax.annotate(text, (1.02, row), xycoords=("axes fraction", "data"), va="center", fontsize=7)
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
    """Plot the correlation matrix of the parameter errors; only the combination of a pair near ±1 is identifiable.

    Args:
        ax: Axes to draw on.
        estimate: The estimate.

    Returns:
        The axes.
    """
    names, correlation = [_short(name) for name in estimate.names], estimate.correlation
    image = ax.imshow(correlation, cmap=DIVERGING, vmin=-1.0, vmax=1.0)
    size = max(2.5, min(7.0, 0.36 * ax.figure.bbox.width / ax.figure.dpi * 72.0 / len(names)))
    ax.set_xticks(range(len(names)), names, rotation=90, fontsize=size)
    ax.set_yticks(range(len(names)), names, fontsize=size)
    ax.grid(visible=False)
    ax.figure.colorbar(image, ax=ax, shrink=0.5, fraction=0.05, pad=0.02, aspect=30, label="correlation [–]")
    return ax


def _short(name: str) -> str:
    """Shorten the name of a sum to its first summand, which is unique; base parameters of arms have long names."""
    return name if len(name) <= 20 else f"{name.split(' ', maxsplit=1)[0]} + …"
