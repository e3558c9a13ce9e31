"""Figures of forces of the ground."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray

from .colours import MEASURED, PREDICTED
from .style import decorate, draw_band


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
