"""Figures of the part of the joint space that a motion covers."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray

from .colours import GUIDE, SHADES, joint_colour
from .style import decorate, draw_samples


def plot_excitation(ax: Axes, q: FloatArray, v: FloatArray, joint: int, label: str) -> Axes:
    """Plot velocity over angle of one joint: a motion that excites friction and inertia fills the plane."""
    draw_samples(ax, np.rad2deg(q), v, joint_colour(joint), size=1.0)
    return decorate(ax, f"{label} angle [deg]", f"{label} velocity [rad/s]", zero=True)


def plot_coverage(
    ax: Axes, q: FloatArray, labels: tuple[str, str], limits: tuple[FloatArray, FloatArray] | None = None
) -> Axes:
    """Plot the angles of two joints against each other: a motion that fills the plane separates gravity parameters."""
    first, second = np.rad2deg(q).T
    draw_samples(ax, first, second, SHADES[2], size=1.0)
    if limits is not None and np.isfinite(limits).all():
        (left, bottom), (right, top) = np.rad2deg(limits)
        ax.plot([left, right, right, left, left], [bottom, bottom, top, top, bottom], color=GUIDE, lw=1.0)
        ax.annotate("limits", (right, top), ha="right", va="bottom", fontsize=6, color="#777777")
    return decorate(ax, f"{labels[0]} angle [deg]", f"{labels[1]} angle [deg]")
