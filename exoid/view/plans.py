"""Figures of planned experiments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from exoid.experiments.excitation import Plan, Precision
from exoid.regression.diagnostics import WEAKLY, WELL

from .colours import CAD, GUIDE, IDENTIFIED, JOINT_COLOURS
from .style import legend_above

IDENTIFIABILITY_COLOURS = {"well": IDENTIFIED, "weakly": "#E69F00", "not": CAD}

LONGEST_BAR = 10.0
"""Relative standard deviation at which bars end, also those of parameters that cannot be identified."""


def plot_planned_motion(axes: Sequence[Axes], plan: Plan, *, motion: int = 0) -> Sequence[Axes]:
    """Plot angles, velocities and expected torques of one period of a plan, with limits as dotted lines.

    Args:
        axes: Three axes to draw on, one above the other.
        plan: The plan.
        motion: Index of the plan's motion.

    Returns:
        The axes.
    """
    recording = plan.recordings[motion]
    shown = recording.time <= plan.motions[motion].period + 1e-9
    limits = plan.limits
    v, tau = recording.v, recording.tau
    assert v is not None and tau is not None  # noqa: PT018 - a plan's recordings have both
    quantities = (
        ("angle [deg]", np.rad2deg(recording.q), np.rad2deg(limits.lower), np.rad2deg(limits.upper)),
        ("velocity [rad/s]", v, -limits.velocity, limits.velocity),
        ("torque [N·m]", tau, -limits.torque, limits.torque),
    )
    for ax, (label, values, lower, upper) in zip(axes, quantities, strict=True):
        for joint, (name, colour) in enumerate(zip(plan.model.leg.joint_labels, JOINT_COLOURS, strict=False)):
            ax.plot(recording.time[shown], values[shown, joint], color=colour, label=name)
        bottom, top = ax.get_ylim()
        margin = 0.2 * (top - bottom)
        for joint, colour in zip(range(len(lower)), JOINT_COLOURS, strict=False):
            for limit in (lower[joint], upper[joint]):
                if bottom - margin <= limit <= top + margin:
                    ax.axhline(limit, color=colour, lw=0.7, ls=":")
        ax.set(ylabel=label)
        ax.yaxis.set_label_coords(-0.13, 0.5)
    legend_above(axes[0])
    axes[-1].set(xlabel="time [s]")
    return axes


def plot_precision(ax: Axes, precision: Precision) -> Axes:
    """Plot the predicted standard deviation of each parameter over its scale, as bars coloured by identifiability.

    Vertical lines mark the largest values that count as "well" and as "weakly" identifiable.

    Args:
        ax: Axes to draw on.
        precision: Predicted precision of a plan or an assessment.

    Returns:
        The axes.
    """
    relative = np.minimum(np.where(np.isfinite(precision.relative), precision.relative, LONGEST_BAR), LONGEST_BAR)
    rows = np.arange(len(relative))[::-1]
    colours = [IDENTIFIABILITY_COLOURS[grade] for grade in precision.identifiability]
    ax.barh(rows, 100.0 * relative, color=colours, height=0.7)
    for limit in (WELL, WEAKLY):
        ax.axvline(100.0 * limit, color=GUIDE, lw=1.0, zorder=0)
    ax.set_yticks(rows, precision.names)
    ax.set_xscale("log")
    ax.set_axisbelow(True)
    ax.xaxis.set_major_formatter("{x:g}")
    ax.set_ylim(-0.6, len(rows) - 0.4)
    ax.grid(visible=False, axis="y")
    ax.set(xlabel="predicted standard deviation [% of scale]")
    grades = [grade for grade in IDENTIFIABILITY_COLOURS if grade in precision.identifiability]
    handles = [Line2D([], [], color=IDENTIFIABILITY_COLOURS[grade], lw=4.0) for grade in grades]
    ax.legend(handles, grades, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.1)
    return ax
