"""Figures of tracking in closed loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.control import LawReplay, Tracking
from exoid.torques.position_units import heading

from .colours import GUIDE, LAW_COLOURS, MEASURED, PREDICTED, RESIDUAL, joint_colour
from .style import decorate, decorate_column


def plot_tracking_errors(
    axes: Sequence[Axes], runs: Mapping[str, Tracking], *, names: Sequence[str], colours: Sequence[str] = LAW_COLOURS
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
    units = next(iter(runs.values())).units
    labels = [f"{name} error [{heading([unit])}]" for name, unit in zip(names, units, strict=True)]
    return _plot_runs(axes, runs, labels, colours, lambda run: run.error / [unit.size for unit in units])


def plot_law_torques(
    axes: Sequence[Axes], runs: Mapping[str, Tracking], *, names: Sequence[str], colours: Sequence[str] = LAW_COLOURS
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
    units = next(iter(runs.values())).units
    labels = [f"{name} {unit.axes['torque']}" for name, unit in zip(names, units, strict=True)]
    return _plot_runs(axes, runs, labels, colours, lambda run: run.tau)


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
    least = 0.3 * min(peak for run in runs.values() for peak in run.peak_deg if peak > 0.0)
    for joint, name in enumerate(names):
        peaks = [run.peak_deg[joint] for run in runs.values()]
        at, colour = rows + 0.8 * ((joint + 0.5) / len(names) - 0.5), joint_colour(joint)
        ax.plot(np.maximum(peaks, least), at, "o", ms=4, color=colour, label=name)
        for peak, row in zip(peaks, at, strict=True):
            place = (max(peak, least), row)  # a logarithmic axis has no zero
            ax.annotate(f"{float(f'{peak:.2g}'):g}", place, (4, 0), textcoords="offset points", va="center", fontsize=6)
    ax.set_yticks(rows, list(runs))
    ax.invert_yaxis()
    ax.margins(x=0.15)
    ax.grid(visible=False, axis="y")
    ax.set_xscale("log")
    return decorate(ax, f"peak error [{heading(next(iter(runs.values())).units)}]", "")


def _plot_runs(
    axes: Sequence[Axes],
    runs: Mapping[str, Tracking],
    labels: Sequence[str],
    colours: Sequence[str],
    values: Callable[[Tracking], FloatArray],
) -> Sequence[Axes]:
    """Plot one quantity of each joint, (N, n), over the time since settling."""
    for joint, ax in enumerate(axes):
        for colour, (label, run) in zip(cycle(colours), runs.items(), strict=False):
            settled = run.time >= run.settle
            ax.plot(run.time[settled] - run.settle, values(run)[settled, joint], color=colour, lw=0.8, label=label)
    return decorate_column(axes, labels, columns=2)


def plot_law_replay(axes: Sequence[Axes], replay: LawReplay) -> Sequence[Axes]:
    """Plot commanded and recorded torque of each joint, with the limits."""
    for joint, ax in enumerate(axes):
        if np.isfinite(replay.recorded[:, joint]).all():
            ax.plot(replay.time, replay.recorded[:, joint], color=MEASURED, lw=0.8, label="recorded")
        ax.plot(replay.time, replay.commanded[:, joint], color=PREDICTED, lw=0.8, label=replay.law)
        if np.isfinite(replay.limit[joint]):
            for limit, label in ((-replay.limit[joint], None), (replay.limit[joint], "limit")):
                ax.axhline(limit, color=RESIDUAL, lw=0.8, ls="--", label=label)
    names = zip(replay.joint_names, replay.units, strict=True)
    return decorate_column(axes, [f"{name} {unit.axes['torque']}" for name, unit in names])
