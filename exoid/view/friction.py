"""Figure of friction as it was measured and as a model has it."""

from __future__ import annotations

from matplotlib.axes import Axes

from exoid._typing import FloatArray

from .colours import GUIDE, IDENTIFIED, joint_colour
from .style import legend_above

DRAWN = 4000
"""Samples drawn, at most."""


def plot_friction_fit(
    ax: Axes, velocity: FloatArray, measured: FloatArray, fitted: FloatArray, joint: int, label: str
) -> Axes:
    """Friction torque of one joint over its velocity: measured torque less all that is not friction, and the model's.

    Both are points sample by sample: friction that depends on load or on the way since a reversal is no curve.

    Args:
        ax: Where to draw.
        velocity: [rad/s], (N,).
        measured: [N·m], (N,).
        fitted: Friction terms of the model, filtered alike [N·m], (N,).
        joint: Which joint, for its colour.
        label: Its name.
    """
    step = max(1, -(-len(velocity) // DRAWN))
    v, points, model = velocity[::step], measured[::step], fitted[::step]
    ax.plot(
        v, points, ".", ms=1.4, color=joint_colour(joint), alpha=0.5, rasterized=True, label="measured less the rest"
    )
    ax.plot(v, model, ".", ms=1.4, color=IDENTIFIED, alpha=0.7, rasterized=True, label="fitted")
    ax.axhline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(xlabel=f"{label} velocity [rad/s]", ylabel=f"{label} friction [N·m]")
    legend_above(ax)
    for handle in ax.get_legend().legend_handles:  # type: ignore[union-attr]
        handle.set(markersize=5, alpha=1.0)  # type: ignore[union-attr]
    return ax
