"""Figures of static and dynamic experiments."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.signals import Approaches, Poses

from .colours import GUIDE, MEASURED, SHADES, joint_colour
from .style import decorate, decorate_column


def plot_approaches(ax: Axes, approaches: Approaches, joint: int, label: str) -> Axes:
    """Plot the holding torque of a joint in poses reached from below (circles) and above (crosses) (doc. 1, Fig. 3)."""
    below, above = approaches.below, approaches.above
    angle = np.rad2deg(below.q[:, joint])
    ax.vlines(angle, above.tau[:, joint], below.tau[:, joint], color=GUIDE, lw=0.8)
    ax.plot(angle, below.tau[:, joint], "o", ms=4, mfc="none", color=MEASURED, label="A⁺, from below")
    ax.plot(np.rad2deg(above.q[:, joint]), above.tau[:, joint], "x", ms=4, color=SHADES[1], label="A⁻, from above")
    return decorate(ax, f"{label} angle [deg]", f"{label} torque [N·m]")


def plot_stiffness(ax: Axes, poses: Poses, sets: FloatArray, totals_deg: FloatArray, joint: int, label: str) -> Axes:
    """Plot torque over the angle of a joint in sets of equal gravity torque, each with a parabola (doc. 1, Fig. 4)."""
    for index, (total, colour) in enumerate(zip(totals_deg, cycle(SHADES), strict=False)):
        in_set = np.asarray(sets) == index
        angle, tau = poses.q[in_set, joint], poses.tau[in_set, joint]
        fine = np.linspace(angle.min(), angle.max(), 60)
        ax.plot(np.rad2deg(fine), np.polyval(np.polyfit(angle, tau, 2), fine), color=colour, lw=0.9)
        ax.plot(np.rad2deg(angle), tau, "o", ms=3, color=colour, label=f"θ₁₂₃ = {total:.0f}°".replace("-", "−"))
    return decorate(ax, f"{label} angle [deg]", f"{label} torque [N·m]")


def plot_torques(
    axes: Sequence[Axes],
    time: FloatArray,
    measured: FloatArray,
    predictions: Sequence[tuple[str, FloatArray, str]],
    labels: Sequence[str],
) -> Sequence[Axes]:
    """Plot measured and predicted torque of each joint (doc. 1, Fig. 7; doc. 2, Fig. 3)."""
    for joint, ax in enumerate(axes):
        ax.plot(time, measured[:, joint], color=MEASURED, lw=2.4, label="measured")
        for name, torque, colour in predictions:
            ax.plot(time, torque[:, joint], color=colour, lw=0.9, label=name)
    return decorate_column(axes, [f"{label} torque [N·m]" for label in labels])


def plot_reference(ax: Axes, time: FloatArray, q: FloatArray, labels: Sequence[str]) -> Axes:
    """Plot reference angles over time (doc. 2, Fig. 6)."""
    for joint, label in enumerate(labels):
        ax.plot(time, np.rad2deg(q[:, joint]), color=joint_colour(joint), label=label)
    return decorate(ax, "time [s]", "flexion [deg]")
