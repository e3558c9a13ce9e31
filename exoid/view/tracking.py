"""Figures of closed loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid.control import Tracking

from .colours import GUIDE
from .style import legend_above

LAW_COLOURS = ("#222222", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00")
"""Of laws, in the order in which they are drawn."""


def plot_tracking_errors(
    axes: Sequence[Axes],
    runs: Mapping[str, Tracking],
    *,
    names: Sequence[str],
    colours: Sequence[str] = LAW_COLOURS,
) -> Sequence[Axes]:
    """Tracking error of each joint under several laws over the counted part of the run, as doc. 2, Fig. 8.

    Args:
        axes: One for each joint.
        runs: What to draw, by the label of each law.
        names: Of the joints.
        colours: Of the laws; they begin anew where there are more laws.
    """
    for joint, (ax, name) in enumerate(zip(axes, names, strict=True)):
        ax.axhline(0.0, color=GUIDE, lw=0.8)
        for colour, (label, run) in zip(cycle(colours), runs.items(), strict=False):
            late = run.time >= run.settle
            ax.plot(run.time[late] - run.settle, np.rad2deg(run.error[late, joint]), color=colour, label=label)
        ax.set(ylabel=f"{name} error [deg]")
    legend_above(axes[0])
    axes[-1].set(xlabel="time [s]")
    return axes


def plot_law_torques(
    axes: Sequence[Axes],
    runs: Mapping[str, Tracking],
    *,
    names: Sequence[str],
    colours: Sequence[str] = LAW_COLOURS,
) -> Sequence[Axes]:
    """Torque of each joint under several laws over the counted part of the run, as doc. 2, Fig. 9.

    Args:
        axes: One for each joint.
        runs: What to draw, by the label of each law.
        names: Of the joints.
        colours: Of the laws; they begin anew where there are more laws.
    """
    for joint, (ax, name) in enumerate(zip(axes, names, strict=True)):
        for colour, (label, run) in zip(cycle(colours), runs.items(), strict=False):
            late = run.time >= run.settle
            ax.plot(run.time[late] - run.settle, run.tau[late, joint], color=colour, lw=0.8, label=label)
        ax.set(ylabel=f"{name} torque [N·m]")
    legend_above(axes[0])
    axes[-1].set(xlabel="time [s]")
    return axes


def plot_peak_errors(ax: Axes, runs: Mapping[str, Tracking], *, names: Sequence[str]) -> Axes:
    """Largest tracking error of each law and joint on a logarithmic scale.

    Args:
        ax: Where to draw.
        runs: What to draw, by the label of each law.
        names: Of the joints.
    """
    place, height = np.arange(len(runs)), 0.8 / len(names)
    for joint, (name, colour) in enumerate(zip(names, LAW_COLOURS[1:], strict=False)):
        peaks = [run.peak_deg[joint] for run in runs.values()]
        bars = ax.barh(place + (joint - 0.5 * (len(names) - 1)) * height, peaks, height, color=colour, label=name)
        ax.bar_label(bars, fmt="%.2g", padding=1.5, fontsize=6)
    ax.set_yticks(place, list(runs))
    ax.invert_yaxis()
    ax.margins(x=0.15)
    ax.set_axisbelow(True)
    ax.grid(visible=False, axis="y")
    ax.set(xscale="log", xlabel="peak error [deg]")
    legend_above(ax)
    return ax
