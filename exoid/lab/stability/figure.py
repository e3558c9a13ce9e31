"""Figures of stability: the Lyapunov function of doc. 2 along runs, and gain margins."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from exoid.view.colours import GUIDE, MEASURED, SHADES
from exoid.view.style import decorate

from .gain_margin import GainMargins
from .lyapunov import Lyapunov
from .regulation import Regulation

CYCLING_COLOURS = ("#B5651D", "#C2A33E", "#7A1F1F")
"""Colours of runs whose V increases often, as on a limit cycle."""


def plot_lyapunov(ax: Axes, curves: Sequence[Lyapunov], labels: Sequence[str] | None = None) -> Axes:
    """Plot V of doc. 2, eq. (29), along runs on a logarithmic scale.

    V decreases, stays constant where stiction holds the leg, or oscillates on a limit cycle. Runs whose V increases
    often have colours that stand out.

    Args:
        ax: Axes to draw on.
        curves: V along each run.
        labels: Label of each run; None for the names of the control laws.

    Returns:
        The axes.
    """
    names = [curve.law for curve in curves] if labels is None else list(labels)
    for curve, name, colour in zip(curves, names, _colours(curves), strict=True):
        # At rest on the target V is zero, which no logarithmic axis can show.
        ax.semilogy(curve.time, np.maximum(curve.value, 1e-8 * curve.value[0]), color=colour, label=name)
    return decorate(ax, "time [s]", "V [J]")


def plot_regulation_errors(ax: Axes, runs: Sequence[Regulation], joint: int, label: str) -> Axes:
    """Plot the error of a joint from its target along runs, and the band in which stiction can hold it.

    Args:
        ax: Axes to draw on.
        runs: Runs to draw; the band is that of the last one.
        joint: Index of the joint.
        label: Name of the joint.

    Returns:
        The axes.
    """
    for run, colour in zip(runs, _colours([run.lyapunov for run in runs]), strict=True):
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


def _colours(curves: Sequence[Lyapunov]) -> list[str]:
    """Colour of each run, by whether its V increases more often than sampling noise explains."""
    settling, cycling = cycle((MEASURED, *SHADES)), cycle(CYCLING_COLOURS)
    return [next(cycling if curve.share_increasing > 0.05 else settling) for curve in curves]
