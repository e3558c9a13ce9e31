"""Torque noise of studies, with known correlation."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.tools.numbers import checked


@dataclass(frozen=True)
class Noise:
    """Stationary noise: the sum of autoregressive noise of first order and white noise.

    Attributes:
        name: Name in results.
        std: Standard deviation at each joint [N·m].
        share: Share of the variance that is correlated, 0 to 1.
        memory: Correlation time, in which the autocorrelation falls to 1/e [s].
    """

    name: str
    std: tuple[float, ...]
    share: float = 0.0
    memory: float = 0.05

    def __post_init__(self) -> None:
        """Check the numbers."""
        checked([*self.std, self.memory], "deviations and memory of noise", above=0.0)
        checked(self.share, "the correlated share of noise", least=0.0, most=1.0)

    def draw(self, rng: np.random.Generator, samples: int, rate: float) -> FloatArray:
        """Draw noise.

        Args:
            rng: Random generator.
            samples: Number of samples N.
            rate: Sampling rate [Hz].

        Returns:
            Noise [N·m], (N, n).
        """
        phi, shape = self._phi(rate), (samples, len(self.std))
        white, innovations = rng.standard_normal(shape), rng.standard_normal(shape)
        innovations[1:] *= math.sqrt(1.0 - phi**2)  # stationary from the first sample on
        coloured = scipy.signal.lfilter([1.0], [1.0, -phi], innovations, axis=0)
        unit = math.sqrt(self.share) * coloured + math.sqrt(1.0 - self.share) * white
        return np.asarray(unit * np.array(self.std))

    def information(self, W: FloatArray, rate: float) -> FloatArray:
        """Compute the Fisher information Σ_j W_jᵀ Γ_j⁻¹ W_j of consecutive rows.

        Let Q be the tridiagonal inverse of the covariance of AR(1) noise of unit variance, and s its share. Then
        Γ⁻¹ = (s Q⁻¹ + (1 − s) I)⁻¹ = (s I + (1 − s) Q)⁻¹ Q.

        Args:
            W: Rows of the regressor, (N, n, P).
            rate: Sampling rate [Hz].

        Returns:
            Information in inverse squared units of the parameters, (P, P).
        """
        phi, share = self._phi(rate), self.share
        diagonal = np.full(len(W), 1.0 + phi**2)
        diagonal[[0, -1]] = 1.0
        beside = -phi / (1.0 - phi**2)
        diagonal /= 1.0 - phi**2
        inner = np.vstack([np.full(len(W), (1.0 - share) * beside), (1.0 - share) * diagonal + share])
        information = np.zeros((W.shape[2],) * 2)
        for joint, std in enumerate(self.std):
            X = W[:, joint]
            QX = diagonal[:, None] * X
            QX[1:] += beside * X[:-1]
            QX[:-1] += beside * X[1:]
            information += X.T @ scipy.linalg.solveh_banded(inner, QX) / std**2
        return information

    def _phi(self, rate: float) -> float:
        return math.exp(-1.0 / (self.memory * rate))
