"""Figures of planned experiments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from exoid.experiments.excitation import Plan
from exoid.experiments.excitation.precision import Precision
from exoid.regression.diagnostics import WEAKLY, WELL
from exoid.torques.position_units import position_units

from .colours import JOINT_COLOURS, MEASURED, RESIDUAL, joint_colour
from .style import decorate, decorate_column, short_name

MARKERS = {"well": ("o", MEASURED), "weakly": ("o", "none"), "not": ("x", MEASURED)}
"""Marker and its filling for each class of identifiability."""


def plot_planned_motion(axes: Sequence[Axes], plan: Plan) -> Sequence[Axes]:
    """Plot angles, velocities and expected torques of the first period of a plan, with limits as dotted lines."""
    recording, limits = plan.recordings[0], plan.limits
    shown = recording.time <= plan.motions[0].period + 1e-9
    v, tau = recording.v, recording.tau
    assert v is not None and tau is not None  # noqa: PT018 - a plan's recordings have both
    units = position_units(plan.model.leg)
    sizes = np.array([unit.size for unit in units])
    quantities = (
        (recording.q / sizes, limits.lower / sizes, limits.upper / sizes),
        (v, -limits.velocity, limits.velocity),
        (tau, -limits.torque, limits.torque),
    )
    for ax, (values, lower, upper) in zip(axes, quantities, strict=True):
        for joint, name in enumerate(plan.model.leg.joint_labels):
            style = "-" if joint < len(JOINT_COLOURS) else "--"  # where colours repeat
            ax.plot(recording.time[shown], values[shown, joint], style, color=joint_colour(joint), label=name)
        bottom, top = ax.get_ylim()
        margin = 0.2 * (top - bottom)
        for joint in range(len(lower)):
            for limit in (lower[joint], upper[joint]):
                if bottom - margin <= limit <= top + margin:
                    ax.axhline(limit, color=joint_colour(joint), lw=0.7, ls=":")
    axes[0].plot([], [], color=MEASURED, lw=0.7, ls=":", label="limits")
    kinds = dict.fromkeys(tuple(unit.axes.items()) for unit in units)  # of joints that turn, and of slides
    return decorate_column(axes, ["\n".join(name for _, name in each) for each in zip(*kinds, strict=True)])


def plot_precision(ax: Axes, precision: Precision) -> Axes:
    """Plot the predicted standard deviation of each parameter over its scale, as dots with the marker of its class."""
    relative = np.minimum(np.where(np.isfinite(precision.relative), precision.relative, np.inf), 10.0)  # of 1000 %
    rows, grades = np.arange(len(relative))[::-1], np.array(precision.identifiability)
    for grade, (marker, filling) in MARKERS.items():
        if len(of_grade := np.flatnonzero(grades == grade)):
            x, y = 100.0 * relative[of_grade], rows[of_grade]
            ax.plot(x, y, marker, ms=4, mec=MEASURED, mfc=filling, ls="none", label=grade)
    for limit, name, dashes in ((WELL, "well", "-"), (WEAKLY, "weakly", "--")):
        ax.axvline(100.0 * limit, color=RESIDUAL, lw=1.0, ls=dashes, zorder=0, label=f"limit of {name}")
    ax.set_yticks(rows, map(short_name, precision.names))
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.set_ylim(-0.6, len(rows) - 0.4)
    decorate(ax, "", "", columns=2).set_xlabel("predicted standard deviation [% of scale]", loc="right")
    return ax
