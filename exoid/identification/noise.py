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

FREQUENCIES = 8192
"""Points at which a spectrum is summed."""

TINY = 1e-30
"""Smallest variance to divide by."""

RING = 1e-5
"""The response of a filter counts as over when it has fallen to this part."""


@dataclass(frozen=True, eq=False)
class AutoregressiveNoise:
    """Noise e_t = Σ_i φ_i e_{t−i} + ε_t with white ε of variance σ².

    Attributes:
        predictors: Best predictors of orders 0 to p, row k holding φ_1 … φ_k, (p + 1, p).
        variances: Of what each of them leaves unexplained, (p + 1,); the last is σ².
    """

    predictors: FloatArray
    variances: FloatArray

    @staticmethod
    def none() -> AutoregressiveNoise:
        """Silence, as in noise-free simulations."""
        return AutoregressiveNoise(np.zeros((1, 0)), np.zeros(1))

    @staticmethod
    def from_autocovariances(gamma: FloatArray, samples: int) -> AutoregressiveNoise:
        """Solve the Yule–Walker equations for all orders (Levinson and Durbin), and choose the order by AIC.

        Args:
            gamma: Autocovariances γ_0 … γ_K; orders up to K are compared.
            samples: Number N of samples that they come from: AIC(p) = N ln σ_p² + 2 p.
        """
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
        return AutoregressiveNoise(predictors[: order + 1, :order], np.array(variances[: order + 1]))

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
        """Independent samples that say as much on the size of the noise as one of these, γ_0² / Σ γ_k².

        By Parseval (mean S)² / mean S² of the spectrum S.
        """
        _, response = scipy.signal.freqz([1.0], self.polynomial, FREQUENCIES, whole=True)
        spectrum = np.abs(response) ** 2
        return float(np.mean(spectrum) ** 2 / np.mean(spectrum**2))

    def quadratic_form(self, X: FloatArray) -> FloatArray:
        """X Γ Xᵀ with Γ the covariance matrix of consecutive samples of the noise.

        With e = Ψ ε and Γ = σ² Ψ Ψᵀ, the rows of X Ψ are those of X filtered by 1 / φ backwards in time, and on beyond
        their beginning until the response is over.

        Args:
            X: Rows over consecutive samples, zero at those left out, (P, N).

        Returns:
            (P, P).
        """
        if self.order == 0:
            return np.asarray(self.variances[-1] * (X @ X.T))
        radius = float(np.abs(np.roots(self.polynomial)).max())
        ring = X.shape[1] if radius >= 1.0 else math.ceil(math.log(RING) / math.log(max(radius, 1e-3)))
        start = np.zeros((len(X), self.order))
        filtered, state = scipy.signal.lfilter([1.0], self.polynomial, X[:, ::-1], zi=start)
        after, _ = scipy.signal.lfilter([1.0], self.polynomial, np.zeros((len(X), min(ring, X.shape[1]))), zi=state)
        return np.asarray(self.variances[-1] * (filtered @ filtered.T + after @ after.T))

    def whiten(self, X: FloatArray) -> FloatArray:
        """Rows with which noise of this kind becomes white of unit variance, exactly from the first sample on.

        Args:
            X: Rows over consecutive samples, none left out, (P, N).
        """
        p = min(self.order, X.shape[1])
        out = np.empty_like(X)
        factor = np.eye(p)
        for k in range(1, p):
            factor[k, :k] = -self.predictors[k, k - 1 :: -1]
        out[:, :p] = (X[:, :p] @ factor.T) / np.sqrt(np.maximum(self.variances[:p], TINY))
        if X.shape[1] > p:
            out[:, p:] = scipy.signal.lfilter(self.polynomial, [1.0], X)[:, p:] / math.sqrt(
                max(self.variances[-1], TINY)
            )
        return out


def autocovariance_sums(x: FloatArray, largest: int) -> FloatArray:
    """Σ_t x_t · x_{t+k} for k = 0 … ``largest``, summed over the rows of x, (P, N) or (N,)."""
    length = scipy.fft.next_fast_len(x.shape[-1] + largest, real=True)
    power = np.zeros(length // 2 + 1)
    for row in np.atleast_2d(x):
        power += np.abs(scipy.fft.rfft(row, length)) ** 2
    return np.asarray(scipy.fft.irfft(power, length)[: largest + 1])
