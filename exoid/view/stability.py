"""Figures of stability: what doc. 2's Lyapunov function does, and how far gains may be raised."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from .colours import CAD, GUIDE, IDENTIFIED, MEASURED, SHADES
from .style import legend_above

if TYPE_CHECKING:
    from exoid.control.stability import GainMargins, Lyapunov, Regulation

LOWEST = 1e-8
"""Share of V at the beginning below which nothing is drawn: rest on the target."""

OFTEN = 0.05
"""Share of the moments at which V rises where it does more than tremble."""

RESTLESS = ("#E69F00", CAD, "#CC79A7")
"""Colours of runs whose V rises often."""


def plot_lyapunov(ax: Axes, curves: Sequence[Lyapunov], labels: Sequence[str] | None = None) -> Axes:
    """V of doc. 2, eq. (29), along runs, on a logarithmic scale: falling, resting short of the target, or cycling.

    Runs whose V rises often stand out.

    Args:
        ax: Where to draw.
        curves: V along each run.
        labels: What was different in each; None for the names of the laws.
    """
    names = [curve.law for curve in curves] if labels is None else list(labels)
    for curve, name, colour in zip(curves, names, _colours(curves), strict=True):
        ax.semilogy(curve.time, np.maximum(curve.value, LOWEST * curve.value[0]), color=colour, label=name)
    ax.set(xlabel="time [s]", ylabel="V [J]")
    legend_above(ax)
    return ax


def plot_regulation_errors(ax: Axes, runs: Sequence[Regulation], joint: int, label: str) -> Axes:
    """Distance of a joint from its target along runs, and the band in which stiction may hold it.

    Args:
        ax: Where to draw.
        runs: The runs; the band is that of the last one.
        joint: Index of the joint.
        label: Its name.
    """
    for run, colour in zip(runs, _colours([run.lyapunov for run in runs]), strict=True):
        ax.plot(run.run.time, np.rad2deg(run.run.error[:, joint]), color=colour, label=run.name)
    band = float(np.rad2deg(runs[-1].equilibrium.band[joint]))
    ax.axhspan(-band, band, color=GUIDE, alpha=0.5, lw=0.0, zorder=0, label="c0 / Kp")
    ax.set(xlabel="time [s]", ylabel=f"{label} error [deg]")
    legend_above(ax)
    return ax


def plot_gain_margins(ax: Axes, margins: GainMargins) -> Axes:
    """Largest stable scale of the gains over the rate of the law, one line for each delay.

    Args:
        ax: Where to draw.
        margins: What was found.
    """
    for delay, column, colour in zip(margins.delays, margins.margins.T, (IDENTIFIED, CAD, *SHADES), strict=False):
        late = f"delay of {delay} period{'' if delay == 1 else 's'}" if delay else "no delay"
        ax.loglog(margins.rates, column, marker="o", ms=3, color=colour, label=late)
    ax.axhline(1.0, color=GUIDE, lw=1.2, zorder=0)
    ax.set(xlabel="rate of the law [Hz]", ylabel="largest stable scale of gains")
    legend_above(ax)
    return ax


def _colours(curves: Sequence[Lyapunov]) -> list[str]:
    calm, restless = cycle((MEASURED, *SHADES)), cycle(RESTLESS)
    return [next(restless if curve.share_increasing > OFTEN else calm) for curve in curves]
