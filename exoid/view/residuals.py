"""Figures of what a model leaves over."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.regression import Trend

from .colours import GUIDE, IDENTIFIED, LEFT_OVER, MEASURED, joint_colour
from .style import legend_above

BINS = 24
"""Of the mean residual along an axis."""

FEWEST = 10
"""A bin of fewer samples has no mean worth drawing."""

DRAWN = 4000
"""Samples drawn as dots, at most."""


def plot_prediction(
    ax: Axes,
    time: FloatArray,
    measured: FloatArray,
    predicted: FloatArray,
    label: str,
    band: FloatArray | None = None,
) -> Axes:
    """Measured and predicted torque of one joint, the residual below them at the same scale, and a prediction band.

    Args:
        ax: Where to draw.
        time: [s], (N,).
        measured: [N·m], (N,).
        predicted: [N·m], (N,).
        label: Name of the joint.
        band: Where a newly measured torque is expected, from and to [N·m], (N, 2).
    """
    if band is not None:
        ax.fill_between(time, band[:, 0], band[:, 1], color=IDENTIFIED, alpha=0.25, lw=0, label="95 % band")
    ax.plot(time, measured, color=MEASURED, lw=0.7, label="measured")
    ax.plot(time, predicted, color=IDENTIFIED, lw=1.3, label="predicted")
    ax.plot(time, measured - predicted, color=LEFT_OVER, lw=0.6, label="residual", zorder=1)
    ax.axhline(0.0, color=GUIDE, lw=0.6, zorder=0)
    ax.set(xlabel="time [s]", ylabel=f"{label} torque [N·m]")
    legend_above(ax, columns=2)
    return ax


def plot_residual_band(ax: Axes, time: FloatArray, residual: FloatArray, half_width: FloatArray) -> Axes:
    """Residual torque of one joint over time, large, within the band in which that of a new measurement is expected.

    Args:
        ax: Where to draw.
        time: [s], (N,).
        residual: Measured less predicted torque [N·m], (N,).
        half_width: Of the band [N·m], (N,).
    """
    ax.fill_between(time, -half_width, half_width, color=IDENTIFIED, alpha=0.25, lw=0)
    ax.plot(time, residual, color=LEFT_OVER, lw=0.6)
    ax.axhline(0.0, color=GUIDE, lw=0.6, zorder=0)
    ax.set(xlabel="time [s]", ylabel="residual [N·m]")
    return ax


def plot_residual_along(
    ax: Axes, x: FloatArray, residual: FloatArray, joint: int, xlabel: str, label: str, trend: Trend | None = None
) -> Axes:
    """Residual against velocity or angle, and its mean ± 2 standard errors in bins of equal count.

    A mean that leaves zero shows what the model lacks: friction, a spring, a wrong geometry.

    Args:
        ax: Where to draw.
        x: Velocity [rad/s] or angle [deg] of each sample, (N,).
        residual: Measured less predicted torque [N·m], (N,).
        joint: Which joint, for its colour.
        xlabel: Of the axis, with unit.
        label: Name of the joint.
        trend: Means and what noise explains of them, as the estimate has tested them on its own recordings
            (:attr:`exoid.Estimate.trends`). None for the means of these samples, whose standard errors take them for
            independent.
    """
    step = max(1, -(-len(x) // DRAWN))
    ax.plot(x[::step], residual[::step], ".", ms=1.2, color=joint_colour(joint), alpha=0.4, rasterized=True)
    if trend is not None:
        edges = np.rad2deg(trend.edges) if trend.against == "angle" else trend.edges
        centre, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
        ax.errorbar(
            centre,
            trend.mean,
            yerr=2.0 * trend.std,
            xerr=half,
            fmt="o",
            ms=2.5,
            lw=1.0,
            color=MEASURED,
            label="mean ± 2 std of what noise leaves",
        )
        legend_above(ax)
    elif parts := [part for part in np.array_split(np.argsort(x, kind="stable"), BINS) if len(part) >= FEWEST]:
        centres = [x[part].mean() for part in parts]
        mean = np.array([residual[part].mean() for part in parts])
        error = 2.0 * np.array([residual[part].std(ddof=1) / np.sqrt(len(part)) for part in parts])
        ax.errorbar(centres, mean, yerr=error, fmt="o-", ms=2.5, lw=1.0, color=MEASURED, label="mean ± 2 s.e.")
        legend_above(ax)
    ax.axhline(0.0, color=GUIDE, lw=0.8, zorder=0)
    ax.set(xlabel=xlabel, ylabel=f"{label} residual [N·m]")
    return ax
