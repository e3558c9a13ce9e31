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

UNSEEN = 10.0
"""Relative standard deviation at which bars end, of parameters that are not determined at all."""


def plot_planned_motion(axes: Sequence[Axes], plan: Plan, *, motion: int = 0) -> Sequence[Axes]:
    """Angles, velocities and expected torques of one period of a plan; dotted where its limits are.

    Args:
        axes: Three of them, one above the other.
        plan: The plan.
        motion: Which of its motions.
    """
    recording = plan.recordings[motion]
    shown = recording.time <= plan.motions[motion].period + 1e-9
    limits = plan.limits
    v, tau = recording.v, recording.tau
    assert v is not None and tau is not None  # noqa: PT018 - a plan's recordings have both
    rows = (
        ("angle [deg]", np.rad2deg(recording.q), np.rad2deg(limits.lower), np.rad2deg(limits.upper)),
        ("velocity [rad/s]", v, -limits.velocity, limits.velocity),
        ("torque [N·m]", tau, -limits.torque, limits.torque),
    )
    for ax, (label, values, low, high) in zip(axes, rows, strict=True):
        for joint, (name, colour) in enumerate(zip(plan.model.leg.joint_labels, JOINT_COLOURS, strict=False)):
            ax.plot(recording.time[shown], values[shown, joint], color=colour, label=name)
        view = ax.get_ylim()
        for joint, colour in zip(range(len(low)), JOINT_COLOURS, strict=False):
            for limit in (low[joint], high[joint]):
                if view[0] - 0.2 * np.ptp(view) <= limit <= view[1] + 0.2 * np.ptp(view):
                    ax.axhline(limit, color=colour, lw=0.7, ls=":")
        ax.set(ylabel=label)
        ax.yaxis.set_label_coords(-0.13, 0.5)
    legend_above(axes[0])
    axes[-1].set(xlabel="time [s]")
    return axes


def plot_precision(ax: Axes, precision: Precision) -> Axes:
    """Predicted standard deviation of each parameter over its scale; lines at which it counts as well or weakly known.

    Args:
        ax: Where to draw.
        precision: Of a plan or an assessment.
    """
    relative = np.minimum(np.where(np.isfinite(precision.relative), precision.relative, UNSEEN), UNSEEN)
    places = np.arange(len(relative))[::-1]
    ax.barh(
        places,
        100.0 * relative,
        color=[IDENTIFIABILITY_COLOURS[grade] for grade in precision.identifiability],
        height=0.7,
    )
    for limit in (WELL, WEAKLY):
        ax.axvline(100.0 * limit, color=GUIDE, lw=1.0, zorder=0)
    ax.set_yticks(places, precision.names)
    ax.set_xscale("log")
    ax.set_axisbelow(True)
    ax.xaxis.set_major_formatter("{x:g}")
    ax.set_ylim(-0.6, len(places) - 0.4)
    ax.grid(visible=False, axis="y")
    ax.set(xlabel="predicted standard deviation [% of scale]")
    kinds = [kind for kind in IDENTIFIABILITY_COLOURS if kind in precision.identifiability]
    handles = [Line2D([], [], color=IDENTIFIABILITY_COLOURS[kind], lw=4.0) for kind in kinds]
    ax.legend(handles, kinds, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.1)
    return ax
