"""How well laws follow a course that know one estimate after the other."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.json_values import attributes, named
from exoid.tables import DataTable

from .design import TRUTH
from .driving import MEASURES


class Spread(NamedTuple):
    """Of a figure over replicates, joint by joint, (n,) each; NaN where there are too few.

    Attributes:
        mean: Mean.
        std: Standard deviation.
        worst: Largest.
    """

    mean: FloatArray
    std: FloatArray
    worst: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class LawFigures:
    """A law that knows estimates from one protocol, noise and estimator; or the truth, or nothing.

    Attributes:
        protocol: Name.
        noise: Name.
        law: Name.
        knows: An estimator, "truth" or "nothing".
        joint_labels: Joints, (n,).
        runs: Tracking error, root mean square and peak [deg], and rms torque [N·m], of each replicate, (R, 3, n); NaN
            where it diverged.
        best: The same where the law knows the truth, with the same noise of the sensors; None where it knows nothing.
    """

    protocol: str
    noise: str
    law: str
    knows: str
    joint_labels: tuple[str, ...]
    runs: FloatArray
    best: FloatArray | None

    @property
    def rms_deg(self) -> Spread:
        """Root mean squared tracking error [deg]."""
        return _spread(self.runs[:, 0])

    @property
    def peak_deg(self) -> Spread:
        """Largest tracking error of a run [deg]."""
        return _spread(self.runs[:, 1])

    @property
    def rms_torque(self) -> Spread:
        """Root mean squared torque [N·m]."""
        return _spread(self.runs[:, 2])

    @property
    def excess_deg(self) -> Spread | None:
        """By how much rms_deg exceeds that of the law that knows the truth, replicate by replicate [deg]."""
        return None if self.best is None else _spread(self.runs[:, 0] - self.best[:, 0])

    @property
    def diverged(self) -> int:
        """Replicates in which the leg ran away, or the estimate made no law."""
        return int(np.isnan(self.runs).any(axis=(1, 2)).sum())

    def to_json(self) -> dict[str, Any]:
        """Figures by joint."""
        spreads: dict[str, Spread | None] = {name: getattr(self, name) for name in (*MEASURES, "excess_deg")}
        columns = {name: np.transpose(spread) for name, spread in spreads.items() if spread is not None}
        return {
            **attributes(self, "protocol", "noise", "law", "knows", "diverged"),
            "joints": {
                label: {name: named(Spread._fields, column[k]) for name, column in columns.items()}
                for k, label in enumerate(self.joint_labels)
            },
        }


def laws_table(caption: str, figures: Iterable[LawFigures]) -> DataTable:
    """Put laws one below the other: a line for each joint and each that the law was told."""
    rows: list[tuple[str, ...]] = []
    for law, each in itertools.groupby(figures, lambda one: one.law):
        rows.append((law, *("",) * 9))
        rows += [(f"  {one.knows}, {label}", *_cells(one, joint)) for one in each for joint, label in _joints(one)]
    headers = ("law, told by", "rms [°]", "std", "worst", "excess", "peak [°]", "std", "worst", "[N·m]", "std")
    return DataTable(caption, headers, rows)


def _joints(figures: LawFigures) -> Iterable[tuple[int, str]]:
    return enumerate(figures.joint_labels)


def _cells(figures: LawFigures, joint: int) -> tuple[str, ...]:
    rms, peak, torque, excess = figures.rms_deg, figures.peak_deg, figures.rms_torque, figures.excess_deg
    over = math.nan if excess is None or figures.knows == TRUTH else excess.mean[joint]
    numbers = (*(x[joint] for x in rms), over, *(x[joint] for x in peak), torque.mean[joint], torque.std[joint])
    return tuple("" if math.isnan(x) else f"{x:.3f}" for x in numbers)


def _spread(values: FloatArray) -> Spread:
    """Over replicates that did not diverge, (R, n)."""
    kept = values[~np.isnan(values).any(axis=1)]
    none = np.full(values.shape[1], np.nan)
    if not len(kept):
        return Spread(none, none, none)
    std = kept.std(axis=0, ddof=1) if len(kept) > 1 else none
    return Spread(kept.mean(axis=0), std, kept.max(axis=0))
