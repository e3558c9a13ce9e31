"""Figure of measured and modelled friction."""

from __future__ import annotations

from matplotlib.axes import Axes

from exoid._typing import FloatArray

from .colours import GUIDE, PREDICTED, joint_colour
from .style import draw_samples, legend_above


def plot_friction_fit(
    ax: Axes, velocity: FloatArray, measured: FloatArray, fitted: FloatArray, joint: int, label: str
) -> Axes:
    """Plot measured and modelled friction torque of one joint over its velocity."""
    # Both are drawn as dots: friction that depends on load, or has memory of the last reversal, is not a function of
    # velocity.
    draw_samples(ax, velocity, measured, joint_colour(joint), size=1.4, label="measured less other terms")
    draw_samples(ax, velocity, fitted, PREDICTED, size=1.4, alpha=0.7, label="fitted")
    ax.axhline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(xlabel=f"{label} velocity [rad/s]", ylabel=f"{label} friction [N·m]")
    legend_above(ax)
    for handle in ax.get_legend().legend_handles:  # type: ignore[union-attr]
        handle.set(markersize=5, alpha=1.0)  # type: ignore[union-attr]
    return ax
