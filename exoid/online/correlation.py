"""Autocorrelation of residuals, and how many rows say as much as one that is independent.

Behind a low-pass, and where the model errs, one row resembles the next. The variance of a mean of N such rows is
c/N of that of one, with c = 1 + 2 Σ_k ρ_k. Sums of slowly varying columns times rows have the same factor; those of
columns that vary faster than the noise a smaller one, so that intervals are rather too wide than too narrow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .settings import LAGS, Settings
from .state import Correlation

MEMORY = 60.0
"""Time constant of the autocorrelation [s]."""

FEWEST = 200.0
"""Pairs of rows from which an autocorrelation is believed."""

NEGLIGIBLE = 0.02
"""Autocorrelation from which on later ones are noise."""


def followed(settings: Settings, before: Correlation, e: FloatArray, used: NDArray[np.bool_]) -> Correlation:
    """Add the residuals of a block."""
    m = len(e)
    discount = float(np.exp(-m * settings.row_time / MEMORY))
    both, mask = np.concatenate([before.tail, e]), np.concatenate([before.used, used])
    width = LAGS + 1
    lagged = np.lib.stride_tricks.sliding_window_view(both, width, axis=0)[:, :, ::-1]  # (m, n, K + 1), lag 0 first
    masked = np.lib.stride_tricks.sliding_window_view(mask, width, axis=0)[:, :, ::-1]
    lagged, masked = lagged[-m:], masked[-m:]
    sums = discount * before.sums + np.einsum("mj,mjk->kj", e, lagged)
    counts = discount * before.counts + np.einsum("mj,mjk->kj", used.astype(np.float64), masked)
    return Correlation(both[-LAGS:], mask[-LAGS:], sums, counts)


def inflations(settings: Settings, correlation: Correlation) -> FloatArray:
    """Rows of each joint that say as much as one independent row."""
    sums, counts = correlation.sums, np.maximum(correlation.counts, 1.0)
    variance = sums[0] / counts[0]
    rho = np.divide(sums[1:] / counts[1:], variance, out=np.zeros_like(sums[1:]), where=variance > 0.0)
    believed = np.cumprod((rho > NEGLIGIBLE) & (counts[1:] >= FEWEST), axis=0)
    return np.asarray(np.maximum(settings.filter_inflation, 1.0 + 2.0 * (np.minimum(rho, 1.0) * believed).sum(axis=0)))
