"""Figure of the comparison of two estimates."""

from __future__ import annotations

from matplotlib.figure import Figure

from exoid.estimate import Estimate
from exoid.estimate.comparison import Comparison
from exoid.view.parameters import plot_comparison

from .page import Picture, on_axes, paper_figure


def comparison_figures(first: Estimate, second: Estimate, comparison: Comparison) -> dict[str, Figure]:
    """Draw the parameters of two estimates beside each other, with their differences.

    Args:
        first: An estimate.
        second: Another one.
        comparison: Their comparison (:func:`exoid.compare`).

    Returns:
        Figures of a paper by name, for :func:`exoid.view.write_figures`.
    """
    units = dict.fromkeys(comparison.units)
    panels = [
        Picture(
            on_axes(plot_comparison, first, second, comparison, unit),
            f"Parameters in {unit} of both estimates with 95 % intervals",
            height=max(1.4, 0.6 + 0.3 * comparison.units.count(unit)),
        )
        for unit in units
    ]
    return {"comparison": paper_figure(panels)}
