"""How well a way to identify predicts rows that it has not seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError
from exoid.identification.fitting import Start, Task
from exoid.identification.identify import fit_model
from exoid.regression.every_row import make_rows
from exoid.regression.rows import for_leg
from exoid.signals import Preparation, Recording, Smoothed, ZeroPhase

GAP = 0.1
"""Rows this near to the tested ones [s] are not fitted either: a low-pass mixes neighbours."""

BLOCK = 1.0
"""Length of the blocks that are sorted by speed [s]."""

TINY = 1e-300
"""Keeps a constant torque from being divided by."""

SLOW = 0.7
"""Share of the blocks, the slowest, from which the others are predicted."""


class Split(NamedTuple):
    """Rows to fit and rows to test.

    Attributes:
        blocks: Start and end of the tested stretches of each recording [s], (K, 2) each.
    """

    blocks: tuple[FloatArray, ...]

    def tested(self, index: int, time: FloatArray) -> NDArray[np.bool_]:
        """Say which rows of a recording are tested."""
        return self._within(index, time, 0.0)

    def fitted(self, index: int, time: FloatArray) -> NDArray[np.bool_]:
        """Say which rows of a recording are fitted."""
        return ~self._within(index, time, GAP)

    def _within(self, index: int, time: FloatArray, margin: float) -> NDArray[np.bool_]:
        inside = np.zeros(len(time), dtype=np.bool_)
        for start, stop in self.blocks[index]:
            inside |= (time >= start - margin) & (time < stop + margin)
        return inside


def blocked_folds(recordings: Sequence[Recording], folds: int) -> tuple[Split, ...]:
    """Cut each recording into as many stretches in time, of which each is tested once."""
    edges = [np.linspace(r.time[0], np.nextafter(r.time[-1], np.inf), folds + 1) for r in recordings]
    return tuple(Split(tuple(edge[None, k : k + 2] for edge in edges)) for k in range(folds))


def fast_blocks(recordings: Sequence[Recording]) -> Split:
    """Test the fastest blocks of a second: how well does friction extrapolate in velocity?"""
    # The speed of a block is the mean over joints of the RMS velocity, each over its RMS in all recordings.
    speeds = [np.abs(np.gradient(r.q, r.time, axis=0)) if r.v is None else np.abs(r.v) for r in recordings]
    size = np.sqrt(np.mean(np.vstack(speeds) ** 2, axis=0))
    starts = [np.arange(r.time[0], r.time[-1], BLOCK) for r in recordings]
    paces = [
        np.array([_pace(speed[(r.time >= start) & (r.time < start + BLOCK)], size) for start in of_one])
        for r, speed, of_one in zip(recordings, speeds, starts, strict=True)
    ]
    limit = np.quantile(np.concatenate(paces), SLOW)
    chosen = [of_one[pace > limit] for of_one, pace in zip(starts, paces, strict=True)]
    return Split(tuple(np.column_stack([of_one, of_one + BLOCK]) for of_one in chosen))


def _pace(speed: FloatArray, size: FloatArray) -> float:
    return float(np.mean(np.sqrt(np.mean(speed**2, axis=0)) / np.where(size > 0.0, size, 1.0))) if len(speed) else 0.0


class Errors(NamedTuple):
    """Prediction errors on the tested rows of one split."""

    squares: FloatArray  # sum of squared residuals of each joint [N²·m²], (n,)
    torque: FloatArray  # sum of measured torques [N·m], (n,)
    torque_squares: FloatArray  # sum of their squares [N²·m²], (n,)
    rows: int  # number of rows

    @staticmethod
    def total(several: Sequence[Errors]) -> Errors:
        """Errors on the rows of all."""
        squares, torque, torque_squares = (np.sum([errors[:3][k] for errors in several], axis=0) for k in range(3))
        return Errors(squares, torque, torque_squares, sum(errors.rows for errors in several))

    @property
    def rms(self) -> FloatArray:
        """Root of the mean squared residual [N·m], (n,)."""
        return np.asarray(np.sqrt(self.squares / self.rows))

    @property
    def measured(self) -> BoolArray:
        """Joints with a torque other than zero, (n,)."""
        return np.asarray(self.torque_squares > 0.0)

    def ratio(self, whole: Errors) -> FloatArray:
        """RMS residual over the spread of the torque; not a number for joints whose torque was not measured."""
        return np.where(whole.measured, self.rms / whole.spread, np.nan)

    @property
    def spread(self) -> FloatArray:
        """Standard deviation of the measured torque [N·m], (n,)."""
        return np.asarray(np.sqrt(np.maximum(self.torque_squares / self.rows - (self.torque / self.rows) ** 2, TINY)))


def held_out(task: Task, recordings: Sequence[Recording], split: Split, start: Start | None, cutoff: float) -> Errors:
    """Fit to the rows that a split leaves, and predict the others."""
    fitted = fit_model(task._replace(keep=split.fitted), start)
    preparation = fitted.problem.preparation
    errors = []
    for index, recording in enumerate(recordings):
        rows = make_rows(fitted.models[0], recording, evaluation(preparation, cutoff, recording.sample_rate))
        tested = split.tested(index, rows.time)
        there = for_leg(fitted.models[0], recording).driven
        residual, torque = ((rows.tau - rows.W @ fitted.values) * there)[tested], rows.tau[tested]
        errors.append(Errors((residual**2).sum(axis=0), torque.sum(axis=0), (torque**2).sum(axis=0), len(residual)))
    if not any(of_one.rows for of_one in errors):
        raise ExoidError("no tested row is left between the ends that filters spoil", remedy="record longer")
    return Errors.total(errors)


def evaluation(preparation: Preparation, cutoff: float, rate: float) -> Preparation:
    """Filter for torques, sampled at ``rate`` [Hz], that is the same for all candidates, with this one's kinematics."""
    if isinstance(preparation, ZeroPhase):
        return ZeroPhase(cutoff, preparation.kinematics_cutoff_at(rate), preparation.order)
    if isinstance(preparation, Smoothed):
        return ZeroPhase(cutoff, preparation.cutoff, preparation.order)
    return preparation
