"""Figures of how much of a joint space a motion visits."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray

from .colours import GUIDE, joint_colour

DRAWN = 4000
"""Samples drawn, at most."""


def plot_excitation(ax: Axes, q: FloatArray, v: FloatArray, joint: int, label: str) -> Axes:
    """Velocity over angle of one joint: a motion that identifies friction and inertia fills the plane.

    Args:
        ax: Where to draw.
        q: Angle [rad], (N,).
        v: Velocity [rad/s], (N,).
        joint: Which joint, for its colour.
        label: Its name.
    """
    step = max(1, -(-len(q) // DRAWN))
    ax.plot(np.rad2deg(q[::step]), v[::step], ".", ms=1.0, color=joint_colour(joint), alpha=0.5, rasterized=True)
    ax.axhline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(xlabel=f"{label} angle [deg]", ylabel=f"{label} velocity [rad/s]")
    return ax


def plot_coverage(
    ax: Axes, q: FloatArray, labels: tuple[str, str], limits: tuple[FloatArray, FloatArray] | None = None
) -> Axes:
    """Angles of two joints against each other: gravity is told apart where they fill the plane.

    Args:
        ax: Where to draw.
        q: Angles of the two [rad], (N, 2).
        labels: Their names.
        limits: Lower and upper joint limits [rad], (2,) each, drawn as a frame where finite.
    """
    step = max(1, -(-len(q) // DRAWN))
    first, second = np.rad2deg(q[::step]).T
    ax.plot(first, second, ".", ms=1.0, color=joint_colour(1), alpha=0.5, rasterized=True)
    if limits is not None and np.isfinite(limits).all():
        (left, bottom), (right, top) = np.rad2deg(limits)
        ax.plot([left, right, right, left, left], [bottom, bottom, top, top, bottom], color=GUIDE, lw=1.0)
        ax.annotate("limits", (right, top), ha="right", va="bottom", fontsize=6, color="#777777")
    ax.set(xlabel=f"{labels[0]} angle [deg]", ylabel=f"{labels[1]} angle [deg]")
    return ax
