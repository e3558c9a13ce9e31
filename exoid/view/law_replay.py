"""Plot of the torque that a controller would have commanded during a log."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from exoid.control import LawReplay

from .colours import GUIDE, MEASURED, PREDICTED
from .style import legend_above


def plot_law_replay(axes: Sequence[Axes], replay: LawReplay) -> Sequence[Axes]:
    """Plot commanded and recorded torque of each joint, with the limits."""
    for joint, (ax, name) in enumerate(zip(axes, replay.joint_names, strict=True)):
        if np.isfinite(replay.recorded[:, joint]).all():
            ax.plot(replay.time, replay.recorded[:, joint], color=MEASURED, lw=0.8, label="recorded")
        ax.plot(replay.time, replay.commanded[:, joint], color=PREDICTED, lw=0.8, label=replay.law)
        if np.isfinite(replay.limit[joint]):
            for limit in (-replay.limit[joint], replay.limit[joint]):
                ax.axhline(limit, color=GUIDE, lw=0.8, ls="--")
        ax.set(ylabel=f"{name} torque [N·m]")
    legend_above(axes[0])
    axes[-1].set(xlabel="time [s]")
    return axes
