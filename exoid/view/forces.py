"""Figures of the torque between wearer and exoskeleton, and of forces of the ground."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.control.wearer import GaitProfile

from .colours import MEASURED, PREDICTED, WEARER, joint_colour
from .style import decorate, draw_band


def plot_interaction(
    ax: Axes, time: FloatArray, torque: FloatArray, band: FloatArray, label: str, quantity: str = "torque [N·m]"
) -> Axes:
    """Plot the torque of the wearer at one joint over time with its band.

    Args:
        ax: Axes to draw on.
        time: Time [s], (N,).
        torque: Torque of the wearer on the leg [N·m], (N,).
        band: Half the width of its 95 % band [N·m], (N,).
        label: Name of the joint.
        quantity: What the wearer gives, with its unit: "force [N]" of a slide.

    Returns:
        The axes.
    """
    draw_band(ax, time, torque, band, WEARER)
    ax.plot(time, torque, color=WEARER, lw=1.0, label="torque of the wearer")
    return decorate(ax, "time [s]", f"{label} {quantity}", zero=True)


def draw_gait_profile(figure: Figure, profile: GaitProfile, labels: tuple[str, ...], unit: str) -> None:
    """Plot mean ± RMS torque and mean power of the wearer over the phase of the gait."""
    above, below = figure.subplots(2, 1, sharex=True)
    percent = 100.0 * profile.phase
    for joint, label in enumerate(labels):
        colour, mean, rms = joint_colour(joint), profile.mean[:, joint], profile.rms[:, joint]
        spread = np.sqrt(np.maximum(rms**2 - mean**2, 0.0))
        above.fill_between(percent, mean - spread, mean + spread, color=colour, alpha=0.2, lw=0)
        style = ("-", "--", "-.", ":")[joint % 4]  # for grey print
        above.plot(percent, mean, color=colour, ls=style, label=label)
        below.plot(percent, profile.power[:, joint], color=colour, ls=style)
    decorate(above, "", f"torque of the\nwearer [{unit}]", zero=True)
    decorate(below, "phase [%]", "power on\nthe leg [W]", zero=True)


def plot_ground_force(
    ax: Axes,
    time: FloatArray,
    predicted: FloatArray,
    half_width: FloatArray,
    measured: FloatArray | None = None,
    label: str = "vertical force [N]",
) -> Axes:
    """Plot one quantity of the ground on a foot: predicted from joint torques, its 95 % band, and measured."""
    broken = np.flatnonzero(np.diff(time) > 0.05) + 1  # no line across gaps [s], in which the foot does not rest
    at, middle, half = (np.insert(x, broken, np.nan) for x in (time, predicted, half_width))
    if measured is not None:
        ax.plot(at, np.insert(measured, broken, np.nan), color=MEASURED, lw=1.8, label="force plate")
    draw_band(ax, at, middle, half)
    ax.plot(at, middle, color=PREDICTED, lw=0.9, label="from joint torques")
    return decorate(ax, "time [s]", label)
