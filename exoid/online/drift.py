"""Slow change of single parameters: estimates of consecutive epochs against those of the first ones.

The rows of an epoch, and no others, give an estimate x_k with the variances of :func:`exoid.online.estimate_of`. Means
over the first epochs, x̄₀, and over the last, x̄₁, are independent. While nothing changes,

    t = (x̄₁ − x̄₀) / (s √(var x̄₀ + var x̄₁))

is about t-distributed for every parameter. s² ≥ 1 is the mean square of the second differences
x_k − 2 x_{k−1} + x_{k−2} over their variance: more than one where errors of the model differ from epoch to epoch,
whatever the slope. By Boole's inequality, P parameters and h epochs an hour raise F false alarms an hour at most if
each test has the level F / (h P).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .correlation import inflations
from .rows import Rows
from .settings import Settings
from .solution import DETERMINED
from .state import Drift, Epochs, State, no_epochs

FIRST = 3
"""Number of epochs of the reference."""

DOF = 20.0
"""Degrees of freedom of the statistic, at least."""

LONGEST = 10.0
"""Rows that do not determine all parameters after so many epochs are given up."""

REMEMBERED = 100
"""Largest number of drifts that a state lists."""


class EpochEstimate(NamedTuple):
    """Estimate by the rows of an epoch."""

    values: FloatArray  # parameters, (P,)
    variances: FloatArray  # their variances, (P,)


def drift_limit(settings: Settings) -> float:
    """Compute the threshold of the statistic by the rate of false alarms."""
    if not settings.false_alarms > 0.0 or settings.forgetting == "none":
        return np.inf
    level = settings.false_alarms * settings.epoch / 3600.0 / settings.count
    return float(scipy.stats.t.isf(0.5 * min(level, 1.0), DOF))


def drifted(settings: Settings, limit: float, state: State, rows: Rows) -> State:
    """Take the rows of a block into the epoch, and compare epochs at its end."""
    epochs = state.epochs
    table = np.concatenate([rows.W, rows.tau[..., None]], axis=2).transpose(1, 0, 2)
    R = np.asarray(np.linalg.qr(np.concatenate([epochs.R, table], axis=1), mode="r"))
    counts = epochs.rows + rows.used.sum(axis=0)
    epochs = epochs._replace(R=R, rows=counts, time=epochs.time + settings.block_time)
    if epochs.time < settings.epoch:
        return state._replace(epochs=epochs)
    found = _of_epoch(settings, epochs, state)
    if found is None:
        late = epochs.time >= LONGEST * settings.epoch
        return state._replace(epochs=_emptied(epochs) if late else epochs)
    return _compared(settings, limit, state._replace(epochs=_emptied(epochs)), found)


def _emptied(epochs: Epochs) -> Epochs:
    """Begin the next epoch."""
    return epochs._replace(R=np.zeros_like(epochs.R), rows=np.zeros_like(epochs.rows), time=0.0)


def _of_epoch(settings: Settings, epochs: Epochs, state: State) -> EpochEstimate | None:
    """Weighted estimate, Σ w_j² c_j A⁻¹ A_j A⁻¹ its covariance; None where the rows do not determine a parameter."""
    weights, inflation = state.weights, inflations(settings, state.correlation)
    weighted = epochs.R * weights[:, None, None]
    factor = np.asarray(np.linalg.qr(weighted.reshape(-1, settings.count + 1), mode="r"))
    root = factor[:-1, :-1]
    size = np.sqrt((root**2).sum(axis=0))
    if not size.all() or not (np.abs(np.diag(root)) > DETERMINED * size).all():
        return None
    inverse = scipy.linalg.lapack.dtrtri(root)[0]
    values = inverse @ factor[:-1, -1]
    residuals = np.linalg.norm(weighted @ np.append(values, -1.0), axis=1)
    noise = residuals**2 / np.maximum(epochs.rows, 1.0)  # 1 where the weights are those of this epoch
    columns = weighted[:, :, :-1] * np.sqrt(np.maximum(noise, 1.0) * inflation)[:, None, None]
    spread = columns.reshape(-1, settings.count) @ (inverse @ inverse.T)
    return EpochEstimate(values, (spread**2).sum(axis=0))


def _compared(settings: Settings, limit: float, state: State, now: EpochEstimate) -> State:
    """Compare the last epochs with the reference."""
    epochs = state.epochs
    if epochs.number >= 2:
        bend = now.values - 2.0 * epochs.values[0] + epochs.values[1]
        variance = now.variances + 4.0 * epochs.variances[0] + epochs.variances[1]
        epochs = epochs._replace(scatter=epochs.scatter + bend**2 / variance, bends=epochs.bends + 1.0)
    unfilled = epochs.references < FIRST
    precision = np.where(unfilled, 1.0 / now.variances, 0.0)
    epochs = epochs._replace(
        score=epochs.score + precision * now.values,
        precision=epochs.precision + precision,
        references=epochs.references + unfilled,
        behind=np.where(unfilled, 0.0, epochs.behind + 1.0),
        values=np.concatenate([now.values[None], epochs.values[:-1]]),
        variances=np.concatenate([now.variances[None], epochs.variances[:-1]]),
        number=epochs.number + 1,
    )
    if epochs.number < FIRST + len(epochs.values):
        return state._replace(epochs=epochs)
    shares = 1.0 / epochs.variances
    recent = (shares * epochs.values).sum(axis=0) / shares.sum(axis=0)
    reference = epochs.score / epochs.precision
    scatter = np.maximum(1.0, epochs.scatter / max(epochs.bends, 1.0))
    std = np.sqrt(scatter * (1.0 / shares.sum(axis=0) + 1.0 / epochs.precision))
    ratio = np.abs(recent - reference) / (std * limit)
    found = np.flatnonzero((ratio > 1.0) & (epochs.behind >= len(epochs.values)))
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
        for k in found
    )
    epochs = _with_new_reference(epochs, found)
    return state._replace(epochs=epochs, drifts=(*state.drifts, *drifts)[-REMEMBERED:])


def _with_new_reference(epochs: Epochs, which: NDArray[np.intp]) -> Epochs:
    """Take the last epochs as reference of the parameters that drifted."""
    shares = 1.0 / epochs.variances[:, which]
    score, precision = epochs.score.copy(), epochs.precision.copy()
    behind = epochs.behind.copy()
    score[which], precision[which] = (shares * epochs.values[:, which]).sum(axis=0), shares.sum(axis=0)
    behind[which] = 0.0
    return epochs._replace(score=score, precision=precision, behind=behind)


def without_epochs(settings: Settings, state: State) -> State:
    """Forget all epochs, as behind a sudden change."""
    return state._replace(epochs=no_epochs(settings.n, settings.count))
