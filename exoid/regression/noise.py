"""Noise whose samples resemble their predecessors: an autoregressive model of it, from autocovariances."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

LARGEST_ORDER = 30
"""Autoregressive orders up to this are compared."""


@dataclass(frozen=True, eq=False)
class AutoregressiveNoise:
    """Noise e_t = Σ_i φ_i e_{t−i} + ε_t with white ε of variance σ²."""

    predictors: FloatArray  # best predictors of orders 0 to p, row k holding φ_1 … φ_k, (p + 1, p)
    variances: FloatArray  # variance that the predictor of each order leaves, (p + 1,); the last is σ²
    samples: float = 0.0  # from how many it was estimated, N; 0 for silence
    # samples of the longest uninterrupted run where these are so short that they limit the lags; None where
    # they do not
    longest_run: int | None = None

    @staticmethod
    def none() -> AutoregressiveNoise:
        """Silence, as in noise-free simulations."""
        return AutoregressiveNoise(np.zeros((1, 0)), np.zeros(1))

    @staticmethod
    def from_autocovariances(gamma: FloatArray, samples: int) -> AutoregressiveNoise:
        """Solve the Yule–Walker equations for all orders (Levinson and Durbin), and choose the order by AIC."""
        if gamma[0] <= 0.0:
            return AutoregressiveNoise.none()
        largest = len(gamma) - 1
        predictors, variances = np.zeros((largest + 1, largest)), [float(gamma[0])]
        for k in range(1, largest + 1):
            before = predictors[k - 1, : k - 1]
            reflection = (gamma[k] - before @ gamma[k - 1 : 0 : -1]) / variances[-1]
            if abs(reflection) >= 1.0:  # corrected autocovariances need not be those of any noise
                break
            predictors[k, : k - 1] = before - reflection * before[::-1]
            predictors[k, k - 1] = reflection
            variances.append(variances[-1] * (1.0 - reflection**2))
        order = int(np.argmin(samples * np.log(variances) + 2.0 * np.arange(len(variances))))
        return AutoregressiveNoise(predictors[: order + 1, :order], np.array(variances[: order + 1]), float(samples))

    @property
    def order(self) -> int:
        """Order p."""
        return len(self.variances) - 1

    @cached_property
    def polynomial(self) -> FloatArray:
        """1, −φ_1, …, −φ_p."""
        return np.concatenate([[1.0], -self.predictors[-1]])

    @cached_property
    def effective_share(self) -> float:
        """Independent samples that say as much on the size of the noise as one of these, γ_0² / Σ γ_k²."""
        # By Parseval (mean S)² / mean S² of the spectrum S.
        _, response = scipy.signal.freqz([1.0], self.polynomial, 8192, whole=True)
        spectrum = np.abs(response) ** 2
        return float(np.mean(spectrum) ** 2 / np.mean(spectrum**2))

    def autocorrelation(self, lag: int) -> float:
        """Compute the autocorrelation of the model."""
        correlations = [1.0]
        for k in range(1, lag + 1):
            row = self.predictors[min(k, self.order)][: min(k, self.order)]
            correlations.append(float(row @ np.array(correlations[: -len(row) - 1 : -1] if len(row) else [])))
        return correlations[lag]

    def quadratic_form(self, X: FloatArray) -> FloatArray:
        """X Γ Xᵀ with Γ the covariance matrix of consecutive samples of the noise, (P, P)."""
        # With e = Ψ ε and Γ = σ² Ψ Ψᵀ, the rows of X Ψ are those of X filtered by 1 / φ backwards in time, and on
        # beyond their beginning until the response is over. Γ is the same with time reversed, so they may be
        # filtered forwards, and on beyond their end.
        if not self.order:
            return np.asarray(self.variances[-1] * (X @ X.T))
        # The response of 1 / φ counts as over when it has fallen to 1e-5
        radius = min(max(float(np.abs(np.roots(self.polynomial)).max()), 1e-3), 1.0 - 1e-12)
        ring = min(X.shape[1], math.ceil(math.log(1e-5) / math.log(radius)))
        passed, state = scipy.signal.lfilter([1.0], self.polynomial, X, zi=np.zeros((len(X), self.order)))
        after, _ = scipy.signal.lfilter([1.0], self.polynomial, np.zeros((len(X), ring)), zi=state)
        return np.asarray(self.variances[-1] * (passed @ passed.T + after @ after.T))


def autocovariance_sums(x: FloatArray, largest: int) -> FloatArray:
    """Σ_t x_t · x_{t+k} for k = 0 … ``largest``, summed over the rows of x, (P, N) or (N,)."""
    # Each row is cut into pieces longer than the lags: the diagonals of the products of a piece with itself and
    # with the next one hold every pair. These are products of matrices, and take less than half the time of
    # Fourier transforms.
    length = largest + 1
    within, across = np.zeros((2, length, length))
    for row in np.atleast_2d(x):
        pieces = np.zeros((len(row) // length + 1, length))
        pieces.reshape(-1)[: len(row)] = row
        within += pieces.T @ pieces
        across += pieces[:-1].T @ pieces[1:]
    pairs = np.pad(np.hstack([within, across]).ravel(), (0, length))  # those of lag k stand k beyond the diagonal
    return np.asarray(pairs.reshape(length, -1)[:, :length].sum(axis=0))
