"""Friction models chosen joint by joint, with the rigid bodies shared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.identification.group_rows import Keep
from exoid.leg import Leg
from exoid.signals import Preparation, Recording

from .cross_validation import Split, blocked_folds
from .design import Design, base_model, form_design
from .normal_equations import Active, NormalEquations, residuals
from .patterns import PLAIN, Column, Grid, Pattern, patterns

SURE = 0.3
"""A coefficient whose standard deviation exceeds this part of it is not determined."""

QUANTILE = 0.6
"""Share of the rows, the slowest of a joint, from which the others are predicted."""

BLOCKS = 20
"""Blocks of consecutive rows, by which the error of a difference is estimated."""

NEARLY = 0.02
"""A squared error that exceeds the least by no more than this part of it is as good,"""

STANDARD_ERRORS = 2.0 / 3.0
"""or by no more than so many standard errors of the difference."""

SWEEPS = 4
"""Sweeps over all joints at most, after those in which all joints have an offset."""

SETTLED = 0.05
"""They end when no joint's predicted torque changes by more than this part of its residual."""

Columns = tuple[Column, ...]
Losses = list[FloatArray]
Candidate = tuple[Pattern, Columns, Losses]


class Fold(NamedTuple):
    """Rows to fit and rows to test.

    Attributes:
        fitted: Mask, (N,).
        tested: Mask, (N,).
    """

    fitted: NDArray[np.bool_]
    tested: NDArray[np.bool_]


def fold_of(split: Split, design: Design) -> Fold:
    """Apply a split of recordings in time to rows.

    Args:
        split: Stretches that are tested.
        design: The rows.

    Returns:
        The fold.
    """
    fitted, tested = np.zeros((2, len(design.time)), dtype=np.bool_)
    for index in np.unique(design.recording):
        mine = np.flatnonzero(design.recording == index)
        fitted[mine] = split.fitted(int(index), design.time[mine])
        tested[mine] = split.tested(int(index), design.time[mine])
    return Fold(fitted, tested)


def fast_fold(speed: FloatArray, quantile: float = QUANTILE) -> Fold:
    """Test rows that are faster than all that are fitted.

    Args:
        speed: Speed of each row, (N,).
        quantile: Share of the rows that are fitted.

    Returns:
        The fold.
    """
    slow = speed <= np.quantile(speed, quantile)
    return Fold(slow, ~slow)


@dataclass
class JointByJoint:
    """Search for the friction model of each joint.

    Attributes:
        leg: The leg.
        recordings: The recordings.
        preparation: Filter and differentiation.
        folds: Number of folds in time.
        keep: Function that selects rows; None for all.
        progress: Called with the share done.
        offset_sweeps: Number of first sweeps in which all joints have an offset: what it is worth shows when the load
            of friction is right.
        chosen: Friction columns of each joint.
        banned: Symbols that a joint must not have.
    """

    leg: Leg
    recordings: Sequence[Recording]
    preparation: Preparation
    folds: int
    keep: Keep | None = None
    progress: Callable[[float], None] | None = None
    offset_sweeps: int = 0
    chosen: list[Columns] = field(default_factory=list)
    banned: list[set[str]] = field(default_factory=list)

    def run(self) -> None:
        """Sweep over the joints until predictions settle."""
        n = len(self.leg.joint_names)
        self.model = base_model(self.leg)
        self.chosen, self.banned = [PLAIN] * n, [set() for _ in range(n)]
        self.grids = [Grid()] * n
        self.sigma = np.ones(n)
        rigid = self._rigid([PLAIN] * n)
        before = None
        sweeps = self.offset_sweeps + SWEEPS
        for sweep in range(sweeps):
            self.with_offset: bool = sweep < self.offset_sweeps
            if sweep > 0:
                rigid = self.base[: len(rigid)]
                self.grids = [Grid().about(columns, sweep) for columns in self.chosen]
            self._form(rigid)
            for joint in range(n):
                self._choose(joint)
                if self.progress is not None:
                    self.progress((sweep * n + joint + 1) / (sweeps * n))
            self._weigh()
            explained = self.design.tau - self.left
            if before is not None and self._moved(explained - before) <= SETTLED and sweep > self.offset_sweeps:
                break
            before = explained

    def ban(self, joint: int, symbol: str) -> None:
        """Choose again for a joint, without a coefficient.

        Args:
            joint: Index of the joint.
            symbol: Symbol of the coefficient.
        """
        self.banned[joint].add(symbol)
        self._choose(joint)
        self._weigh()

    def _rigid(self, chosen: Sequence[Columns]) -> FloatArray:
        """Rigid-body parameters with plain friction."""
        self.design = self._design(chosen, None)
        self._weigh()
        self._weigh()
        return self.base[: len(self.leg.parameter_names)]

    def _form(self, rigid: FloatArray) -> None:
        """Form columns of all settings, under the load of these rigid bodies, and normal equations of all folds."""
        library = [
            tuple(dict.fromkeys((*grid.columns, *chosen))) for grid, chosen in zip(self.grids, self.chosen, strict=True)
        ]
        self.design = self._design(library, rigid)
        in_time = [fold_of(split, self.design) for split in blocked_folds(self.recordings, self.folds)]
        self.all_folds = [*in_time, *(fast_fold(np.abs(speed)) for speed in self.design.v.T)]
        self.equations = [self._normal(fold.fitted) for fold in self.all_folds]
        self.whole = self._normal(np.ones(len(self.design.time), dtype=np.bool_))

    def _design(self, library: Sequence[Columns], rigid: FloatArray | None) -> Design:
        preparations = [self.preparation] * len(self.recordings)
        return form_design(self.model, self.recordings, preparations, library, rigid, self.keep)

    def _normal(self, rows: NDArray[np.bool_]) -> NormalEquations:
        return NormalEquations.of(self.design, rows / self.sigma[:, None] ** 2)

    @property
    def active(self) -> Active:
        """Indices of the chosen columns of each joint."""
        return [self.design.indices(joint, columns) for joint, columns in enumerate(self.chosen)]

    def _weigh(self) -> None:
        """Solve for the choice, and weigh each joint's rows by its residual."""
        whole = self._normal(np.ones(len(self.design.time), dtype=np.bool_))
        self.base, self.friction = whole.solve(self.active)
        self.left = residuals(self.design, self.active, self.base, self.friction)
        floor = 1e-9 * np.sqrt(np.mean(self.design.tau**2))
        self.sigma = np.maximum(np.sqrt(np.mean(self.left**2, axis=1)), floor)

    def _moved(self, change: FloatArray) -> float:
        return float((np.sqrt(np.mean(change**2, axis=1)) / self.sigma).max())

    def _choose(self, joint: int) -> None:
        """Choose the friction of one joint: fewest numbers within one standard error of the least error."""
        grid = self.grids[joint]
        whole = self.whole.project(joint, self.active)
        projected = [equations.project(joint, self.active) for equations in self.equations]
        folds = [*range(self.folds), self.folds + joint]
        candidates: list[Candidate] = []
        gains: dict[Pattern, float] = {}
        for pattern in patterns():
            if self.banned[joint] & set(pattern.symbols) or (self.with_offset and "offset" not in pattern.symbols):
                continue
            settings = grid.settings(pattern)
            sets = np.array([self.design.indices(joint, columns) for columns in settings])
            solved = whole.solve(sets)
            best = self._best(pattern, *solved)
            if best is None:
                continue
            gain = float(solved[2][best])
            if any(other >= gain for simpler, other in gains.items() if simpler.within(pattern)):
                continue  # a bound would be active: the best positive coefficients are those of the simpler model
            gains[pattern] = gain
            losses = []
            for k in folds:
                c, _, lower = projected[k].solve(sets)
                good = pattern.dissipative(c)
                index = int(np.argmax(np.where(good, lower, -np.inf))) if good.any() else best
                losses.append(self._loss(k, joint, sets[index]))
            candidates.append((pattern, settings[best], losses))
        self.chosen[joint] = _fewest(candidates)

    def _best(self, pattern: Pattern, c: FloatArray, variance: FloatArray, gain: FloatArray) -> int | None:
        """Index of the best setting whose coefficients are positive and determined; None if there is none."""
        limit = (SURE * c) ** 2 * self.design.independent_fraction
        sure = (variance <= limit) | np.array([symbol == "offset" for symbol in pattern.symbols], dtype=np.bool_)
        good = pattern.dissipative(c) & sure.all(axis=1)
        return int(np.argmax(np.where(good, gain, -np.inf))) if good.any() else None

    def _loss(self, fold: int, joint: int, columns: NDArray[np.intp]) -> FloatArray:
        """Weighted squared errors of the tested rows of a fold, averaged over blocks of them."""
        active = [columns if j == joint else k for j, k in enumerate(self.active)]
        base, friction = self.equations[fold].solve(active)
        tested = self.all_folds[fold].tested
        left = residuals(_rows(self.design, tested), active, base, friction)
        return np.asarray(np.sum((left / self.sigma[:, None]) ** 2, axis=0))


def _rows(design: Design, rows: NDArray[np.bool_]) -> Design:
    """Some rows."""
    return design._replace(
        tau=design.tau[:, rows], base=design.base[:, rows], friction=tuple(F[rows] for F in design.friction)
    )


def _fewest(candidates: Sequence[Candidate]) -> Columns:
    """Columns with the fewest numbers among those nearly as good as the best."""
    scores = [sum(_score(of_folds)) for _, _, of_folds in candidates]
    best = int(np.argmin(scores))
    for k in sorted(range(len(candidates)), key=lambda k: (candidates[k][0].complexity, scores[k])):
        slack = max(NEARLY * scores[best], STANDARD_ERRORS * _error(candidates[k][2], candidates[best][2]))
        if scores[k] - scores[best] <= slack:
            return candidates[k][1]
    return candidates[best][1]


def _score(losses: Losses) -> tuple[float, float]:
    """Mean loss over the folds in time, and over the fast one."""
    return float(np.concatenate(list(losses[:-1])).mean()), float(np.mean(losses[-1]))


def _error(losses: Losses, best: Losses) -> float:
    """Standard error of the difference of two candidates, block by block."""
    variance = 0.0
    for mine, other in ((losses[:-1], best[:-1]), (losses[-1:], best[-1:])):
        difference = np.concatenate(list(mine)) - np.concatenate(list(other))
        means = [part.mean() for part in np.array_split(difference, min(BLOCKS, len(difference)))]
        variance += float(np.var(means, ddof=1)) / len(means) if len(means) > 1 else 0.0
    return float(np.sqrt(variance))
