"""Figures of identified parameters and their uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.estimate.comparison import SIGNIFICANT, Comparison
from exoid.tools.tables import with_error

from .colours import CAD, GUIDE, IDENTIFIED, MEASURED, RESIDUAL
from .style import legend_above, short_name

STRONG = 0.8
"""Correlation from which on a pair is hard to separate: to know one exactly would leave 0.6 of the other's error."""


def plot_parameters(
    ax: Axes,
    estimate: Estimate,
    names: Sequence[str] | None = None,
    other_values: Mapping[str, Mapping[str, float]] | None = None,
) -> Axes:
    """Plot parameters of one unit with 95 % intervals and standard deviations, and other values to compare.

    Args:
        ax: Axes to draw on.
        estimate: The estimate.
        names: Names of the parameters, all of one unit; None for all parameters that have the unit of the first.
        other_values: Values by parameter name, by label, for example of CAD; missing parameters are not drawn.

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
    rows = _draw_intervals(ax, estimate, chosen, "identified, 95 %", "o", IDENTIFIED)
    markers = (("D", CAD), ("s", MEASURED), ("^", RESIDUAL))
    for (label, others), (marker, colour) in zip((other_values or {}).items(), markers, strict=False):
        present = [(others[name], row) for name, row in zip(chosen, rows, strict=True) if name in others]
        if present:
            ax.plot(*zip(*present, strict=True), marker, ms=4, mfc="none", color=colour, label=label)
    errors = (estimate.std[estimate.names.index(name)] for name in chosen)
    texts = [_with_error(estimate.value(name), std) for name, std in zip(chosen, errors, strict=True)]
    return _label_rows(ax, [short_name(name) for name in chosen], texts, f"[{units[chosen[0]]}]", "value ± std")


def plot_comparison(ax: Axes, first: Estimate, second: Estimate, comparison: Comparison, unit: str) -> Axes:
    """Plot the common parameters of one unit of two estimates with 95 % intervals, and their differences.

    Args:
        ax: Axes to draw on.
        first: An estimate.
        second: Another one.
        comparison: Their comparison (:func:`exoid.compare`).
        unit: Unit of the parameters to draw.

    Returns:
        The axes. A star marks a difference that is significant at 5 % of all.
    """
    chosen = [k for k, its_unit in enumerate(comparison.units) if its_unit == unit]
    names = [comparison.names[k] for k in chosen]
    _draw_intervals(ax, first, names, "first, 95 %", "o", IDENTIFIED, -0.16)
    _draw_intervals(ax, second, names, "second, 95 %", "D", CAD, 0.16)
    texts = [
        _with_error(comparison.difference[k], comparison.std[k]) + " *" * bool(comparison.adjusted[k] < SIGNIFICANT)
        for k in chosen
    ]
    return _label_rows(ax, [short_name(name) for name in names], texts, f"[{unit}]", "difference ± std")


def _draw_intervals(
    ax: Axes, estimate: Estimate, names: Sequence[str], label: str, marker: str, colour: str, below: float = 0.0
) -> FloatArray:
    """Draw values with confidence intervals, one a row or a part of a row below it; return the rows."""
    index = [estimate.names.index(name) for name in names]
    values, rows = estimate.values[index], np.arange(len(names)) + below
    error = np.abs(estimate.interval()[index].T - values)
    style: dict[str, Any] = {"fmt": marker, "ms": 3.5, "mfc": "white" if below > 0.0 else colour, "color": colour}
    ax.errorbar(values, rows, xerr=error, label=label, capsize=2.5, zorder=3, **style)
    return np.asarray(rows, dtype=np.float64)


def _with_error(value: float, std: float) -> str:
    """Write a value with its standard deviation, if it has any."""
    return (" ± ".join(with_error(value, std)) if std > 0.0 else f"{value:.6g}").replace("-", "−")


def _label_rows(ax: Axes, names: Sequence[str], texts: Sequence[str], xlabel: str, footer: str = "") -> Axes:
    """Name the rows on the left, and write a text on the right of each above a footer."""
    for row, text in enumerate(texts):
        ax.annotate(text, (1.02, row), xycoords=("axes fraction", "data"), va="center", fontsize=7)
    # Below the column, beside the label of the axis: a legend above may be wider than the axes.
    below: dict[str, Any] = {"xytext": (0, -24), "textcoords": "offset points", "fontsize": 7, "annotation_clip": False}
    ax.annotate(footer, (1.02, 0.0), xycoords="axes fraction", **below)
    ax.axvline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(yticks=range(len(names)), yticklabels=names, xlabel=xlabel, ylim=(len(names) - 0.5, -0.5))
    ax.grid(visible=False, axis="y")
    legend_above(ax)
    return ax


def plot_correlation(ax: Axes, estimate: Estimate) -> Axes:
    """Plot the correlation of the errors of pairs of parameters that are hard to separate, the strongest first.

    Near ±1 only a combination of the pair is identifiable.

    Args:
        ax: Axes to draw on.
        estimate: The estimate.

    Returns:
        The axes.
    """
    pairs = strongest_pairs(estimate)
    values = [estimate.correlation[pair] for pair in pairs]
    ax.plot(values, range(len(pairs)), "o", ms=4, color=IDENTIFIED)
    ax.hlines(range(len(pairs)), 0.0, values, color=IDENTIFIED, lw=1.0)
    names = [" – ".join(short_name(estimate.names[k]) for k in pair) for pair in pairs]
    texts = [f"{value:+.2f}".replace("-", "−") for value in values]
    ax.set_xlim(-1.05, 1.05)
    _label_rows(ax, names, texts, "").set_xlabel("correlation of the errors [–]", loc="right")
    return ax


def strongest_pairs(estimate: Estimate) -> list[tuple[int, int]]:
    """Indices of parameters whose errors correlate by :data:`STRONG` or more, at least 3 pairs and at most 16."""
    size = np.abs(estimate.correlation)
    pairs = sorted(combinations(range(len(size)), 2), key=lambda pair: -size[pair])
    return pairs[: min(16, max(3, sum(size[pair] >= STRONG for pair in pairs)))]
