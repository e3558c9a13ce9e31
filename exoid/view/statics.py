"""Figures of static experiments."""

from __future__ import annotations

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.signals import Approaches, Poses

from .colours import CAD, GUIDE, IDENTIFIED, SHADES
from .style import legend_above


def plot_approaches(ax: Axes, approaches: Approaches, joint: int, label: str) -> Axes:
    """Torque that holds a joint, reached from below (circles) and from above (crosses), as doc. 1, Fig. 3.

    Args:
        ax: Where to draw.
        approaches: The poses.
        joint: Which joint.
        label: Its name.
    """
    below, above = approaches.below, approaches.above
    angle = np.rad2deg(below.q[:, joint])
    ax.vlines(angle, above.tau[:, joint], below.tau[:, joint], color=GUIDE, lw=0.8)
    ax.plot(angle, below.tau[:, joint], "o", ms=4, mfc="none", color=IDENTIFIED, label="A⁺, from below")
    ax.plot(np.rad2deg(above.q[:, joint]), above.tau[:, joint], "x", ms=4, color=CAD, label="A⁻, from above")
    ax.set(xlabel=f"{label} angle [deg]", ylabel=f"{label} torque [N·m]")
    legend_above(ax)
    return ax


def plot_stiffness(ax: Axes, poses: Poses, sets: FloatArray, totals_deg: FloatArray, joint: int, label: str) -> Axes:
    """Torque over the angle of a joint in sets of equal gravity, with a parabola through each, as doc. 1, Fig. 4.

    Args:
        ax: Where to draw.
        poses: The poses.
        sets: Which set each belongs to, (K,).
        totals_deg: θ123 of each set [deg].
        joint: Which joint.
        label: Its name.
    """
    for index, (total, colour) in enumerate(zip(totals_deg, cycle(SHADES), strict=False)):
        of_set = np.asarray(sets) == index
        angle, tau = poses.q[of_set, joint], poses.tau[of_set, joint]
        fine = np.linspace(angle.min(), angle.max(), 60)
        ax.plot(np.rad2deg(fine), np.polyval(np.polyfit(angle, tau, 2), fine), color=colour, lw=0.9)
        ax.plot(np.rad2deg(angle), tau, "o", ms=3, color=colour, label=f"θ₁₂₃ = {total:.0f}°".replace("-", "−"))
    ax.set(xlabel=f"{label} angle [deg]", ylabel=f"{label} torque [N·m]")
    legend_above(ax)
    return ax
