"""Figures of stability: regulation with friction that is compensated in part or too much, and gain margins."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid.view.colours import GUIDE, MEASURED, SHADES
from exoid.view.style import decorate

from .gain_margin import GainMargins
from .regulation import Regulation

CYCLING_COLOURS = ("#B5651D", "#C2A33E", "#7A1F1F")
"""Colours of runs that end in a limit cycle."""


def plot_regulation_errors(ax: Axes, runs: Sequence[Regulation], joint: int, label: str) -> Axes:
    """Plot the error of a joint from its target along runs, and the band in which stiction can hold it.

    Runs that end in a limit cycle have colours that stand out.

    Args:
        ax: Axes to draw on.
        runs: Runs to draw; the band is that of the last one.
        joint: Index of the joint.
        label: Name of the joint.

    Returns:
        The axes.
    """
    for run, colour in zip(runs, _colours(runs), strict=True):
        ax.plot(run.run.time, np.rad2deg(run.run.error[:, joint]), color=colour, label=run.name)
    band = float(np.rad2deg(runs[-1].equilibrium.band[joint]))
    ax.axhspan(-band, band, color=GUIDE, alpha=0.5, lw=0.0, zorder=0, label="c0 / Kp")
    return decorate(ax, "time [s]", f"{label} error [deg]")


def plot_gain_margins(ax: Axes, margins: GainMargins) -> Axes:
    """Plot the largest stable scale of the gains over the control rate, one line for each delay.

    Args:
        ax: Axes to draw on.
        margins: Gain margins by rate and delay.

    Returns:
        The axes.
    """
    for delay, column, colour in zip(margins.delays, margins.margins.T, reversed(SHADES), strict=False):
        label = f"delay of {delay} period{'' if delay == 1 else 's'}" if delay else "no delay"
        ax.loglog(margins.rates, column, marker="o", ms=3, color=colour, label=label)
    ax.axhline(1.0, color=GUIDE, lw=1.2, zorder=0)
    return decorate(ax, "rate of the law [Hz]", "largest stable scale of gains")


def _colours(runs: Sequence[Regulation]) -> list[str]:
    """Colour of each run, by whether it ends in a limit cycle."""
    settling, cycling = cycle((MEASURED, *SHADES)), cycle(CYCLING_COLOURS)
    return [next(cycling if run.outcome == "limit cycle" else settling) for run in runs]
