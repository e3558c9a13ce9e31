"""Figure of a day: torques of the joints, true forces of the contacts, and what was told of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray

from .colours import GUIDE, MEASURED, PREDICTED, joint_colour
from .style import decorate


class DayPart(NamedTuple):
    """One function of a day.

    Attributes:
        name: Name of the function.
        time: Times from its beginning [s], (N,).
        torque: Torques of the joints [N·m], (N, n).
        force: True upward force of each contact [N], (N,).
        blocks: Times of the decisions [s], (K,).
        told: Upward force of each contact as told by the model [N], (K,); zero in the air.
    """

    name: str
    time: FloatArray
    torque: FloatArray
    force: Mapping[str, FloatArray]
    blocks: FloatArray
    told: Mapping[str, FloatArray]


def plot_day(figure: Figure, parts: Sequence[DayPart], joints: Sequence[str]) -> None:
    """Draw torques, and below them the force of each contact: true and told.

    Args:
        figure: Figure to draw on.
        parts: Functions in order.
        joints: Names of the joints.
    """
    contacts = list(parts[0].force)
    axes = figure.subplots(1 + len(contacts), 1, sharex=True, height_ratios=[2.0] + [1.0] * len(contacts))
    begin = 0.0
    for part in parts:
        for ax in axes:
            ax.axvline(begin, color=GUIDE, lw=0.5)
        axes[-1].annotate(part.name, (begin, 1.05), xycoords=("data", "axes fraction"), fontsize=5)
        for j, joint in enumerate(joints):
            label = joint if part is parts[0] else None
            axes[0].plot(begin + part.time, part.torque[:, j], color=joint_colour(j), lw=0.4, label=label)
        for ax, contact in zip(axes[1:], contacts, strict=True):
            first = part is parts[0] and ax is axes[1]  # one legend; names of functions stand above the last axes
            ax.plot(begin + part.time, part.force[contact], color=MEASURED, lw=0.8, label="true" if first else None)
            ax.plot(begin + part.blocks, part.told[contact], color=PREDICTED, lw=0.4, label="told" if first else None)
        begin += float(part.time[-1])
    decorate(axes[0], "", "torque [N·m]", zero=True)
    for k, (ax, contact) in enumerate(zip(axes[1:], contacts, strict=True)):
        last = k == len(contacts) - 1
        top = 1.2 * max(float(np.quantile(part.force[contact], 0.99)) for part in parts)
        ax.set_ylim(-0.05 * top, max(top, 1.0))
        decorate(ax, "time of the day [s]" if last else "", f"{contact} [N]")
