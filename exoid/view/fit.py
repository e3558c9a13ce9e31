"""Figures of a fit: predictions, residuals and friction."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import FloatArray
from exoid.torques.position_units import TURNS, PositionUnit

from .colours import MEASURED, PREDICTED, RESIDUAL, joint_colour
from .style import decorate, draw_samples


def plot_prediction(
    ax: Axes,
    time: FloatArray,
    measured: FloatArray,
    predicted: FloatArray,
    label: str,
    band: FloatArray | None = None,
    quantity: str = "torque [N·m]",
) -> Axes:
    """Plot measured and predicted torque of one joint, the residual on the same scale, and a prediction band.

    Args:
        ax: Axes to draw on.
        time: Time [s], (N,).
        measured: Measured torque [N·m], (N,).
        predicted: Predicted torque [N·m], (N,).
        label: Name of the joint.
        band: Lower and upper limit of the 95 % prediction band [N·m], (N, 2).
        quantity: What is measured, with its unit: "force [N]" of a slide.

    Returns:
        The axes.
    """
    if band is not None:
        ax.fill_between(time, band[:, 0], band[:, 1], color=PREDICTED, alpha=0.3, lw=0, label="95 % band")
    ax.plot(time, measured, color=MEASURED, lw=2.2, label="measured")
    ax.plot(time, predicted, color=PREDICTED, lw=0.9, label="predicted")
    ax.plot(time, measured - predicted, color=RESIDUAL, lw=0.6, label="residual", zorder=1)
    return decorate(ax, "time [s]", f"{label} {quantity}", zero=True, columns=2)


def plot_residual_trend(
    ax: Axes, x: FloatArray, residual: FloatArray, joint: int, xlabel: str, label: str, unit: str = "N·m"
) -> Axes:
    """Plot the residual against velocity or angle, and its mean ± 2 standard errors in bins of equal count.

    A mean that differs from zero shows a missing term: friction, a spring, or wrong geometry. The standard errors
    assume independent samples.

    Args:
        ax: Axes to draw on.
        x: Velocity [rad/s] or angle [deg] of each sample, (N,).
        residual: Measured less predicted torque [N·m], (N,).
        joint: Index of the joint; selects the colour.
        xlabel: Label of the horizontal axis, with unit.
        label: Name of the joint.
        unit: Unit of the residual; N of a slide.

    Returns:
        The axes.
    """
    draw_samples(ax, x, residual, joint_colour(joint), size=1.2, alpha=0.4)
    bins = [rows for rows in np.array_split(np.argsort(x, kind="stable"), 24) if len(rows) >= 10]
    if bins:
        centre, mean = (np.array([each[rows].mean() for rows in bins]) for each in (x, residual))
        error = np.array([residual[rows].std(ddof=1) / np.sqrt(len(rows)) for rows in bins])
        ax.errorbar(centre, mean, 2.0 * error, fmt="o", ms=2.5, lw=1.0, color=MEASURED, label="mean ± 2 s.e. if white")
    return decorate(ax, xlabel, f"{label} residual [{unit}]", zero=True)


def plot_friction_fit(
    ax: Axes, velocity: FloatArray, measured: FloatArray, fitted: FloatArray, label: str, unit: PositionUnit = TURNS
) -> Axes:
    """Plot measured and modelled friction torque of one joint over its velocity."""
    # Dots, as friction that depends on load, or has memory of the last reversal, is not a function of velocity
    draw_samples(ax, velocity, measured, MEASURED, size=1.4, alpha=0.3, label="measured less other terms")
    draw_samples(ax, velocity, fitted, PREDICTED, size=1.4, alpha=0.7, label="fitted")
    return decorate(ax, f"{label} {unit.axes['velocity']}", f"{label} friction [{unit.torque}]", zero=True)
