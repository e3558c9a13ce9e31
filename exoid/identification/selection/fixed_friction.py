"""Held-out errors of friction models that are chosen: with other filters, and with Huber's weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.signals import Preparation, Recording
from exoid.signals.noise_size import robust_std
from exoid.torques import TorqueModel

from .cross_validation import Errors, Split, blocked_folds, evaluation, fast_blocks
from .design import Design, form_design
from .normal_equations import NormalEquations, residuals
from .patterns import Column
from .per_joint import fold_of

CLIP = 1.345
"""Residuals beyond so many standard deviations are clipped by Huber's estimator."""

PASSES, ROBUST_PASSES = 2, 8
"""Solutions at most to settle the weights of joints, and those of rows."""


class HeldOut(NamedTuple):
    """Errors on rows that were not fitted."""

    nrmse: FloatArray  # NRMSE of each joint over all folds, (n,)
    folds: FloatArray  # NRMSE averaged over the joints, of each fold, (K,)
    extrapolation: FloatArray  # NRMSE of the fastest seconds predicted from the others, (n,)


def held_out_errors(
    model: TorqueModel,
    recordings: Sequence[Recording],
    preparation: Preparation,
    chosen: Sequence[Sequence[Column]],
    rigid: FloatArray,
    *,
    folds: int,
    cutoff: float,
    robust: bool,
) -> HeldOut:
    """Predict each stretch of the recordings from the others, with fixed friction models."""
    fitted = form_design(model, recordings, [preparation] * len(recordings), chosen, rigid)
    how = [evaluation(preparation, cutoff, r.sample_rate) for r in recordings]
    compared = form_design(model, recordings, how, chosen, rigid, whole=True)
    each = [_errors(split, fitted, compared, robust=robust) for split in blocked_folds(recordings, folds)]
    whole = Errors.total(each)
    of_folds = np.array([np.mean(errors.rms / whole.spread) for errors in each])
    fast = _errors(fast_blocks(recordings), fitted, compared, robust=robust)
    return HeldOut(whole.rms / whole.spread, of_folds, fast.rms / fast.spread)


def _errors(split: Split, fitted: Design, compared: Design, *, robust: bool) -> Errors:
    """Errors on the tested rows of one split; not a number where rows are too few."""
    active = [np.arange(columns.shape[1]) for columns in fitted.friction]
    used, tested = fold_of(split, fitted).fitted, fold_of(split, compared).tested
    count = fitted.base.shape[2] + max((len(k) for k in active), default=0)
    if used.sum() < count or not tested.any():
        nothing = np.full(len(fitted.tau), np.nan)
        return Errors(nothing, nothing, nothing, 1)
    weights = np.broadcast_to(used.astype(np.float64), fitted.tau.shape)
    for _ in range(ROBUST_PASSES if robust else PASSES):
        base, friction = NormalEquations.of(fitted, weights).solve(active)
        left = residuals(fitted, active, base, friction)
        weights = _weights(left, used.astype(np.float64), robust=robust)
    base, friction = NormalEquations.of(fitted, weights).solve(active)
    left = residuals(compared, active, base, friction)[:, tested]
    torque = compared.tau[:, tested]
    return Errors((left**2).sum(axis=1), torque.sum(axis=1), (torque**2).sum(axis=1), int(tested.sum()))


def _weights(left: FloatArray, used: FloatArray, *, robust: bool) -> FloatArray:
    """Weights of squared residuals: of joints by their size, and of rows beyond the clip."""
    rows = left[:, used > 0.0]
    scale = robust_std(rows.T) if robust else np.sqrt(np.mean(rows**2, axis=1))
    scale = np.maximum(scale, 1e-9 * np.sqrt(np.mean(left**2)) + 1e-300)[:, None]
    clipped = np.minimum(1.0, CLIP * scale / np.maximum(np.abs(left), 1e-300)) if robust else 1.0
    return np.asarray(used * clipped / scale**2)
