"""Slow change of single parameters: estimates of consecutive epochs against those of the first ones.

The rows of an epoch, and no others, give an estimate x_k with the variances of
:func:`exoid.online.solution.estimate_of`. Means over the first epochs, x̄₀, and over the last, x̄₁, are independent.
While nothing changes,

    t = (x̄₁ − x̄₀) / (s √(var x̄₀ + var x̄₁))

is about t-distributed for every parameter. s² ≥ 1 is the mean square of the second differences
x_k − 2 x_{k−1} + x_{k−2} over their variance: more than one where errors of the model differ from epoch to epoch,
whatever the slope. By Boole's inequality, P parameters and h epochs an hour raise F false alarms an hour at most if
each test has the level F / (h P).
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .rows import Rows
from .settings import Settings
from .solution import inflations, inverse_of
from .state import REMEMBERED, Drift, Epochs, State

FIRST = 3
"""Number of epochs of the reference."""


def follow_epochs(settings: Settings, state: State, rows: Rows) -> State:
    """Take the rows of a block into the epoch, and compare epochs at its end."""
    epochs = state.epochs
    epochs = epochs._replace(
        R=np.asarray(np.linalg.qr(np.concatenate([epochs.R, rows.table], axis=1), mode="r")),
        rows=epochs.rows + rows.used.sum(axis=0),
        time=epochs.time + settings.block_time,
    )
    if epochs.time < settings.epoch:
        return state._replace(epochs=epochs)
    found = _of_epoch(settings, epochs, state)
    emptied = epochs._replace(R=np.zeros_like(epochs.R), rows=np.zeros_like(epochs.rows), time=0.0)
    if found is None:  # rows that do not determine all parameters after ten epochs are given up
        return state._replace(epochs=emptied if epochs.time >= 10.0 * settings.epoch else epochs)
    return _compared(settings, state, _with_epoch(emptied, *found))


def _of_epoch(settings: Settings, epochs: Epochs, state: State) -> tuple[FloatArray, FloatArray] | None:
    """Weighted estimate and its variances, diag Σ w_j² c_j A⁻¹ A_j A⁻¹; None where rows do not determine it."""
    weighted = epochs.R * state.weights[:, None, None]
    factor = np.asarray(np.linalg.qr(weighted.reshape(-1, settings.count + 1), mode="r"))
    inverse = inverse_of(factor)
    if inverse is None:
        return None
    values = inverse @ factor[:-1, -1]
    residuals = np.linalg.norm(weighted @ np.append(values, -1.0), axis=1)
    noise = residuals**2 / np.maximum(epochs.rows, 1.0)  # 1 where the weights are those of this epoch
    inflation = inflations(settings, state.correlation)
    columns = weighted[:, :, :-1] * np.sqrt(np.maximum(noise, 1.0) * inflation)[:, None, None]
    spread = columns.reshape(-1, settings.count) @ (inverse @ inverse.T)
    return values, (spread**2).sum(axis=0)


def _with_epoch(epochs: Epochs, values: FloatArray, variances: FloatArray) -> Epochs:
    """Add an estimate to the last ones, to the scatter, and to the reference as long as that has too few."""
    if epochs.number >= 2:
        bend = values - 2.0 * epochs.values[0] + epochs.values[1]
        variance = variances + 4.0 * epochs.variances[0] + epochs.variances[1]
        epochs = epochs._replace(scatter=epochs.scatter + bend**2 / variance, bends=epochs.bends + 1.0)
    unfilled = epochs.references < FIRST
    precision = np.where(unfilled, 1.0 / variances, 0.0)
    return epochs._replace(
        score=epochs.score + precision * values,
        precision=epochs.precision + precision,
        references=epochs.references + unfilled,
        behind=np.where(unfilled, 0.0, epochs.behind + 1.0),
        values=np.concatenate([values[None], epochs.values[:-1]]),
        variances=np.concatenate([variances[None], epochs.variances[:-1]]),
        number=epochs.number + 1,
    )


def _compared(settings: Settings, state: State, epochs: Epochs) -> State:
    """Compare the last epochs with the reference; where a parameter drifted, they are its new reference."""
    if epochs.number < FIRST + len(epochs.values):
        return state._replace(epochs=epochs)
    shares = 1.0 / epochs.variances
    sums, precision = (shares * epochs.values).sum(axis=0), shares.sum(axis=0)
    recent, reference = sums / precision, epochs.score / epochs.precision
    scatter = np.maximum(1.0, epochs.scatter / max(epochs.bends, 1.0))
    std = np.sqrt(scatter * (1.0 / precision + 1.0 / epochs.precision))
    ratio = np.abs(recent - reference) / (std * settings.drift_limit)
    moved = (ratio > 1.0) & (epochs.behind >= len(epochs.values))
    drifts = tuple(
        Drift(
            sample=state.samples,
            time=state.samples / settings.rate,
            joint=settings.parameter_joint[k],
            parameter=settings.model.names[k],
            before=float(reference[k]),
            after=float(recent[k]),
            std=float(std[k]),
            statistic=float(ratio[k]),
        )
        for k in np.flatnonzero(moved)
    )
    epochs = epochs._replace(
        score=np.where(moved, sums, epochs.score),
        precision=np.where(moved, precision, epochs.precision),
        behind=np.where(moved, 0.0, epochs.behind),
    )
    return state._replace(epochs=epochs, drifts=(*state.drifts, *drifts)[-REMEMBERED:])
