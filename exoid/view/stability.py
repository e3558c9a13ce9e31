"""Figures of stability: what doc. 2's Lyapunov function does, and how far gains may be raised."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from .style import CAD, GUIDE, IDENTIFIED, MEASURED, SHADES, legend_above

if TYPE_CHECKING:
    from exoid.control.stability import GainMargins, Lyapunov

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
    calm, restless = cycle((MEASURED, *SHADES)), cycle(RESTLESS)
    for curve, name in zip(curves, names, strict=True):
        colour = next(restless if curve.share_increasing > OFTEN else calm)
        ax.semilogy(curve.time, np.maximum(curve.value, LOWEST * curve.value[0]), color=colour, label=name)
    ax.set(xlabel="time [s]", ylabel="V [J]")
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
    ax.set(xlabel="rate of the law [Hz]", ylabel="largest stable scale of Kp and Kd")
    legend_above(ax)
    return ax
