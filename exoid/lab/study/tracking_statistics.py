"""Statistics of tracking by controllers with different estimates."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.tools.json_values import attributes, named
from exoid.tools.tables import DataTable

from .design import TRUTH
from .tracking_runs import MEASURES

HEADERS = ("controller, parameters", *("rms [°]", "std", "worst", "excess", "peak [°]", "std", "worst", "[N·m]", "std"))
"""Columns of :func:`statistics_table`."""


class Spread(NamedTuple):
    """Spread of a metric over replicates, by joint, (n,) each; NaN if there are too few."""

    mean: FloatArray  # mean
    std: FloatArray  # standard deviation
    worst: FloatArray  # largest value


@dataclass(frozen=True, eq=False, repr=False)
class TrackingStatistics:
    """Tracking by a controller with the estimates of one protocol, noise and estimator, with the truth or no model."""

    protocol: str  # name of the protocol
    noise: str  # name of the noise
    law: str  # name of the controller
    knows: str  # source of its parameters: an estimator, "truth" or "nothing"
    joint_labels: tuple[str, ...]  # labels of the joints, (n,)
    # RMS and peak tracking error [deg] and RMS torque [N·m] of each replicate, (R, 3, n); NaN if it diverged
    runs: FloatArray
    # the same with the true parameters and the same sensor noise; None for a controller without a model
    best: FloatArray | None

    @property
    def rms_deg(self) -> Spread:
        """RMS tracking error [deg]."""
        return _spread(self.runs[:, 0])

    @property
    def peak_deg(self) -> Spread:
        """Largest tracking error of a run [deg]."""
        return _spread(self.runs[:, 1])

    @property
    def rms_torque(self) -> Spread:
        """RMS torque [N·m]."""
        return _spread(self.runs[:, 2])

    @property
    def excess_deg(self) -> Spread | None:
        """RMS tracking error minus that of the same controller with the true parameters, by replicate [deg]."""
        return None if self.best is None else _spread(self.runs[:, 0] - self.best[:, 0])

    @property
    def diverged(self) -> int:
        """Number of replicates that diverged, or for which no controller could be made."""
        return int(np.isnan(self.runs).any(axis=(1, 2)).sum())

    def to_json(self) -> dict[str, Any]:
        """Convert the statistics to JSON types."""
        spreads: dict[str, Spread | None] = {name: getattr(self, name) for name in (*MEASURES, "excess_deg")}
        columns = {name: np.transpose(spread) for name, spread in spreads.items() if spread is not None}
        return {
            **attributes(self, "protocol", "noise", "law", "knows", "diverged"),
            "joints": {
                label: {name: named(Spread._fields, column[k]) for name, column in columns.items()}
                for k, label in enumerate(self.joint_labels)
            },
        }


def statistics_table(caption: str, figures: Iterable[TrackingStatistics]) -> DataTable:
    """Make a table of several controllers."""
    rows: list[tuple[str, ...]] = []
    for law, each in itertools.groupby(figures, lambda one: one.law):
        rows.append((law, *("",) * 9))
        rows += [
            (f"  {one.knows}, {label}", *_cells(one, joint))
            for one in each
            for joint, label in enumerate(one.joint_labels)
        ]
    return DataTable(caption, HEADERS, rows)


def _cells(figures: TrackingStatistics, joint: int) -> tuple[str, ...]:
    rms, peak, torque, excess = figures.rms_deg, figures.peak_deg, figures.rms_torque, figures.excess_deg
    over = math.nan if excess is None or figures.knows == TRUTH else excess.mean[joint]
    numbers = (*(x[joint] for x in rms), over, *(x[joint] for x in peak), torque.mean[joint], torque.std[joint])
    return tuple("" if math.isnan(x) else f"{x:.3f}" for x in numbers)


def _spread(values: FloatArray) -> Spread:
    """Spread over replicates that did not diverge, (R, n)."""
    kept = values[~np.isnan(values).any(axis=1)]
    none = np.full(values.shape[1], np.nan)
    if not len(kept):
        return Spread(none, none, none)
    std = kept.std(axis=0, ddof=1) if len(kept) > 1 else none
    return Spread(kept.mean(axis=0), std, kept.max(axis=0))
