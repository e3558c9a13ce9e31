"""Figure of a day: torques of the joints, true forces of the contacts, and what was told of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.control.functions import SIDES

from .colours import GUIDE, MEASURED, PREDICTED, joint_colour


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
    """Draw the torques of each leg, and below them the force of each contact: true and told.

    Names of functions stand at the top where the function changes. A force beyond the axis is marked by a triangle.

    Args:
        figure: Figure to draw on.
        parts: Functions in order.
        joints: Names of the joints, those of the left leg first.
    """
    contacts, per_leg = list(parts[0].force), len(joints) // len(SIDES)
    axes = figure.subplots(len(SIDES) + len(contacts), 1, sharex=True, height_ratios=[1.5, 1.5] + [1.0] * len(contacts))
    begins, tops = np.cumsum([0.0, *(float(part.time[-1]) for part in parts)]), dict.fromkeys(contacts, 1.0)
    for contact in contacts:
        tops[contact] = max(1.0, *(1.2 * float(np.quantile(part.force[contact], 0.99)) for part in parts))
    for k, (begin, part) in enumerate(zip(begins, parts, strict=False)):
        if k == 0 or part.name != parts[k - 1].name:
            for ax in axes:
                ax.axvline(begin, color=GUIDE, lw=0.6)
            place = axes[0].get_xaxis_transform()
            axes[0].text(begin, 1.03, part.name, rotation=90, fontsize=7, transform=place)
        for j, joint in enumerate(joints):
            label = joint.split("_")[-1] if k == 0 and j < per_leg else None
            ax, colour = axes[j // per_leg], joint_colour(j % per_leg)
            ax.plot(begin + part.time, part.torque[:, j], color=colour, lw=0.7, label=label)
        for ax, contact in zip(axes[len(SIDES) :], contacts, strict=True):
            first = k == 0 and contact == contacts[0]
            force, top = part.force[contact], tops[contact]
            ax.plot(begin + part.time, force, color=MEASURED, lw=0.8, label="true" if first else None)
            ax.plot(begin + part.blocks, part.told[contact], color=PREDICTED, lw=0.6, label="told" if first else None)
            if force.max() > top:
                ax.plot(begin + part.time[force.argmax()], 0.97 * top, "^", color=MEASURED, ms=3.0)
    for side, ax in zip(SIDES, axes[: len(SIDES)], strict=True):
        ax.axhline(0.0, color=GUIDE, lw=0.8, zorder=0)
        ax.set(ylabel=f"{side} torque [N·m]")
    figure.legend(loc="outside lower center", ncols=per_leg + 2)
    for ax, contact in zip(axes[len(SIDES) :], contacts, strict=True):
        ax.set(ylim=(-0.05 * tops[contact], tops[contact]), ylabel=f"{contact} [N]")
    axes[-1].set(xlabel="time of the day [s]", xlim=(0.0, begins[-1]))
    figure.align_ylabels(list(axes))
