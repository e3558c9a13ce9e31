"""Figures of tracking in closed loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.control import Tracking

from .colours import GUIDE, LAW_COLOURS, joint_colour
from .style import legend_above


def plot_tracking_errors(
    axes: Sequence[Axes],
    runs: Mapping[str, Tracking],
    *,
    names: Sequence[str],
    colours: Sequence[str] = LAW_COLOURS,
) -> Sequence[Axes]:
    """Plot the tracking error of each joint under several control laws, after settling (doc. 2, Fig. 8).

    Args:
        axes: Axes to draw on, one for each joint.
        runs: Runs by the label of each control law.
        names: Names of the joints.
        colours: Colours of the laws; repeated if there are more laws.

    Returns:
        The axes.
    """
    for ax in axes:
        ax.axhline(0.0, color=GUIDE, lw=0.8)
    return _plot_runs(axes, runs, names, colours, lambda run: np.rad2deg(run.error), "error [deg]")


def plot_law_torques(
    axes: Sequence[Axes],
    runs: Mapping[str, Tracking],
    *,
    names: Sequence[str],
    colours: Sequence[str] = LAW_COLOURS,
) -> Sequence[Axes]:
    """Plot the torque of each joint under several control laws, after settling (doc. 2, Fig. 9).

    Args:
        axes: Axes to draw on, one for each joint.
        runs: Runs by the label of each control law.
        names: Names of the joints.
        colours: Colours of the laws; repeated if there are more laws.

    Returns:
        The axes.
    """
    return _plot_runs(axes, runs, names, colours, lambda run: run.tau, "torque [N·m]", width=0.8)


def plot_peak_errors(ax: Axes, runs: Mapping[str, Tracking], *, names: Sequence[str]) -> Axes:
    """Plot the largest tracking error of each control law and joint as dots on a logarithmic scale.

    Args:
        ax: Axes to draw on.
        runs: Runs by the label of each control law.
        names: Names of the joints.

    Returns:
        The axes.
    """
    rows = np.arange(len(runs))
    for joint, name in enumerate(names):
        peaks = [run.peak_deg[joint] for run in runs.values()]
        at, colour = rows + 0.6 * ((joint + 0.5) / len(names) - 0.5), joint_colour(joint)
        ax.plot(peaks, at, "o", ms=4, color=colour, label=name)
        for peak, row in zip(peaks, at, strict=True):
            ax.annotate(f"{peak:.2g}", (peak, row), (4, 0), textcoords="offset points", va="center", fontsize=6)
    ax.set_yticks(rows, list(runs))
    ax.invert_yaxis()
    ax.margins(x=0.15)
    ax.set_axisbelow(True)
    ax.grid(visible=False, axis="y")
    ax.set(xscale="log", xlabel="peak error [deg]")
    legend_above(ax)
    return ax


def _plot_runs(
    axes: Sequence[Axes],
    runs: Mapping[str, Tracking],
    names: Sequence[str],
    colours: Sequence[str],
    values: Callable[[Tracking], FloatArray],
    quantity: str,
    width: float | None = None,
) -> Sequence[Axes]:
    """Plot one quantity of each joint, (N, n), over the time since settling."""
    for joint, (ax, name) in enumerate(zip(axes, names, strict=True)):
        for colour, (label, run) in zip(cycle(colours), runs.items(), strict=False):
            settled = run.time >= run.settle
            time, value = run.time[settled] - run.settle, values(run)[settled, joint]
            ax.plot(time, value, color=colour, lw=width, label=label)
        ax.set(ylabel=f"{name} {quantity}")
    legend_above(axes[0], columns=2)
    axes[-1].set(xlabel="time [s]")
    return axes
