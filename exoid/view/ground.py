"""Figures of forces of the ground."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray

from .colours import MEASURED, PREDICTED
from .style import legend_above

BREAK = 0.05
"""Lines are not drawn across gaps longer than this [s], in which the foot does not rest."""


def plot_ground_force(
    ax: Axes,
    time: FloatArray,
    predicted: FloatArray,
    half_width: FloatArray,
    measured: FloatArray | None = None,
    label: str = "vertical force [N]",
) -> Axes:
    """Plot one quantity of the ground on a foot: predicted from joint torques, its 95 % band, and measured."""
    broken = np.flatnonzero(np.diff(time) > BREAK) + 1
    at, middle, half = (np.insert(x, broken, np.nan) for x in (time, predicted, half_width))
    if measured is not None:
        ax.plot(at, np.insert(measured, broken, np.nan), color=MEASURED, lw=1.8, label="force plate")
    ax.fill_between(at, middle - half, middle + half, color=PREDICTED, alpha=0.35, lw=0, label="95 % band", zorder=2)
    ax.plot(at, middle, color=PREDICTED, lw=0.9, label="from joint torques")
    ax.set(xlabel="time [s]", ylabel=label)
    legend_above(ax, columns=3)
    return ax
