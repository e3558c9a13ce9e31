"""Held-out errors: how well friction models that are chosen predict rows that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.signals import Recording

from .design import Design
from .normal_equations import NormalEquations, residuals

Blocks = tuple[FloatArray, ...]
"""Start and end of the tested stretches of each recording [s], (K, 2) each."""


class Fold(NamedTuple):
    """Rows to fit and rows to test."""

    fitted: NDArray[np.bool_]  # mask, (N,)
    tested: NDArray[np.bool_]  # mask, (N,)


def blocked_folds(recordings: Sequence[Recording], folds: int) -> list[Blocks]:
    """Cut each recording into as many stretches in time, of which each is tested once."""
    edges = [np.linspace(r.time[0], np.nextafter(r.time[-1], np.inf), folds + 1) for r in recordings]
    return [tuple(edge[None, k : k + 2] for edge in edges) for k in range(folds)]


def fast_blocks(recordings: Sequence[Recording]) -> Blocks:
    """Test the fastest 30 % of blocks of a second: how well does friction extrapolate in velocity?"""
    # The speed of a block is the mean over joints of the RMS velocity, each over its RMS in all recordings.
    speeds = [np.abs(np.gradient(r.q, r.time, axis=0)) if r.v is None else np.abs(r.v) for r in recordings]
    size = np.sqrt(np.mean(np.vstack(speeds) ** 2, axis=0))
    size = np.where(size > 0.0, size, 1.0)
    starts = [r.time[0] + np.arange(max(1.0, np.round(r.duration))) for r in recordings]  # no rest of a few rows
    paces = []
    for r, speed, of_one in zip(recordings, speeds, starts, strict=True):
        seconds = [speed[(r.time >= start) & (r.time < start + 1.0)] for start in of_one]
        paces.append(np.array([np.mean(np.sqrt(np.mean(v**2, axis=0)) / size) if len(v) else 0.0 for v in seconds]))
    limit = np.quantile(np.concatenate(paces), 0.7)
    chosen = [of_one[pace > limit] for of_one, pace in zip(starts, paces, strict=True)]
    return tuple(np.column_stack([of_one, of_one + 1.0]) for of_one in chosen)


def fold_of(blocks: Blocks, design: Design) -> Fold:
    """Apply a split of recordings in time to rows; rows within 0.1 s of tested ones are not fitted either."""
    near, tested = np.zeros((2, len(design.time)), dtype=np.bool_)  # a low-pass mixes neighbours
    for index, of_one in enumerate(blocks):
        mine, time = design.recording == index, design.time
        for start, stop in of_one:
            tested |= mine & (time >= start) & (time < stop)
            near |= mine & (time >= start - 0.1) & (time < stop + 0.1)
    return Fold(~near, tested)


def held_out_errors(
    fitted: Design, recordings: Sequence[Recording], folds: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Predict each stretch of the recordings from the others, with the friction models of a design."""
    # NRMSE of each joint over all folds, (n,); averaged over the joints, of each fold, (K,); and of the fastest
    # seconds, (n,). Compared are weighted means of the torques around each row, up to the ends of segments.
    gain = fitted.gain[:, None]
    friction = tuple(F / gain for F in fitted.friction)
    compared = fitted._replace(tau=fitted.tau / fitted.gain, base=fitted.base / gain, friction=friction)
    each = [_residuals(blocks, fitted, compared) for blocks in blocked_folds(recordings, folds)]
    left, torque, moves = (np.hstack(rows) for rows in zip(*each, strict=True))
    # NRMSE of a fold is over the spread of the torque in the whole, so that calm folds do not count more.
    spread = _spread(torque, moves)
    # The torque of a passive joint is zero: its NRMSE has no meaning, and would decide for all joints.
    still = spread <= 1e-9 * spread.max()
    of_folds = np.array([np.mean((rms(of_one, rows) / spread)[~still]) for of_one, _, rows in each])
    fast, fast_torque, fast_moves = _residuals(fast_blocks(recordings), fitted, compared)
    extrapolation = rms(fast, fast_moves) / _spread(fast_torque, fast_moves)
    nrmse, extrapolation = (np.where(still, np.nan, x) for x in (rms(left, moves) / spread, extrapolation))
    return nrmse, of_folds, extrapolation


def rms(rows: FloatArray, moves: NDArray[np.bool_]) -> FloatArray:
    """Root of the mean square of each joint where it moves, (n,); other rows are zero."""
    return np.asarray(np.sqrt(np.sum(rows**2, axis=1) / np.maximum(moves.sum(axis=1), 1)))


def _spread(torque: FloatArray, moves: NDArray[np.bool_]) -> FloatArray:
    """Standard deviation of the torque of each joint where it moves, (n,)."""
    mean = torque.sum(axis=1) / np.maximum(moves.sum(axis=1), 1)
    return np.maximum(rms(moves * (torque - mean[:, None]), moves), 1e-150)


def _residuals(blocks: Blocks, fitted: Design, compared: Design) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Residuals, torques and moves of the tested rows of one split, (n, K) each; not numbers where rows are too few."""
    active = [np.arange(columns.shape[1]) for columns in fitted.friction]
    used, tested = fold_of(blocks, fitted)  # rows of both designs are at the same times
    count = fitted.base.shape[2] + max((len(k) for k in active), default=0)
    if used.sum() < count or not tested.any():
        nothing = np.full((len(fitted.tau), 1), np.nan)
        return nothing, nothing, np.ones(nothing.shape, dtype=np.bool_)
    weights = np.broadcast_to(used.astype(np.float64), fitted.tau.shape)
    for _ in range(2):  # weights of the joints and residuals in turn
        base, friction = NormalEquations.of(fitted, weights).solve(active)
        scale = rms(residuals(fitted, active, base, friction)[:, used], fitted.moves[:, used])
        weights = used / np.maximum(scale, 1e-9 * scale.max() + 1e-300)[:, None] ** 2
    base, friction = NormalEquations.of(fitted, weights).solve(active)
    return residuals(compared, active, base, friction)[:, tested], compared.tau[:, tested], compared.moves[:, tested]
