"""How surely the noise is known from which the variance of a parameter follows."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .least_squares import Solution
from .noise import AutoregressiveNoise
from .problem import RowProblem
from .residuals import Noises, Point, Series, over_recordings
from .rows import NoiseKind

TINY = 1e-300
"""Smallest variance to divide by."""


def degrees_of_freedom(
    problem: RowProblem, point: Point, noises: Noises, solution: Solution, *, whitened: bool
) -> FloatArray:
    """Satterthwaite's ν_i = 2 V_i² / var V_i of each parameter's variance V_i, (P,); infinite where V_i is exact.

    The variance of a parameter hangs on the noise at the frequencies of the motion, and of those a recording shows few
    periods: ν is well below the number of samples. With the autoregressive noise of kind and joint known to
    var ln σ² = 2 / N, cov φ = σ² Γ_p⁻¹ / N (Brockwell and Davis, ch. 8), var V_i is that of first order in both. Of N
    samples a share P / Σ N went into the parameters; for white noise of one joint ν = N − P, as in textbooks. That the
    order was chosen counts as certain.

    Args:
        problem: The problem.
        point: Where it was solved.
        noises: The noise that the covariance is for.
        solution: Covariance V, and (WᵀW)⁻¹ of the weighted rows.
        whitened: Whether V = (W Γ⁻¹ Wᵀ)⁻¹, not the sandwich.
    """
    rows = solution.covariance if whitened else solution.inverse
    slopes: dict[tuple[NoiseKind, int], FloatArray] = {}
    for of_recording in over_recordings(problem, point, partial(_slopes, noises, rows, whitened)):
        for key, slope in of_recording.items():
            slopes[key] = slopes.get(key, 0.0) + slope
    samples = sum(noises[key].samples for key in slopes)
    left = max(1.0 - float(np.count_nonzero(np.diag(rows))) / max(samples, 1.0), TINY)
    spread = sum(_spread(noises[key], slope) for key, slope in slopes.items()) / left
    variance = np.diag(solution.covariance)
    return np.asarray(np.divide(2.0 * variance**2, spread, out=np.full(len(variance), np.inf), where=spread > TINY))


def _slopes(
    noises: Noises, rows: FloatArray, whitened: bool, parts: Iterator[Series]
) -> dict[tuple[NoiseKind, int], FloatArray]:
    """Slopes of what one recording adds to V_i, by kind and joint."""
    slopes: dict[tuple[NoiseKind, int], FloatArray] = {}
    running: dict[int, _Slope] = {}
    for part in parts:
        key = (part.kind, part.joint)
        if part.begins:
            running[part.joint] = _Slope(noises[key], len(rows), whitened)
        running[part.joint].add(rows[:, part.columns] @ part.X, part.usable)
        if part.ends:
            slopes[key] = (1.0 if whitened else part.stands_for**2) * running[part.joint].total()
    return slopes


def _spread(noise: AutoregressiveNoise, slope: FloatArray) -> FloatArray:
    """Variance of V_i that the noise of one kind and joint leaves, given dV_i / d(ln σ², φ), (P,)."""
    of_predictors = noise.variances[-1] * (noise.whiten(slope[:, 1:]) ** 2).sum(axis=1) if noise.order else 0.0
    return np.asarray((2.0 * slope[:, 0] ** 2 + of_predictors) / max(noise.samples, 1.0))


class _Slope:
    """dV_i / d(ln σ², φ_1 … φ_p) of what one joint adds to V_i, from rows b_i that come stretch by stretch.

    In the sandwich V_i = σ² Σ y², with y = b / φ(L) and ∂y/∂φ_k = L^k y / φ(L). Whitened, b = V X, V_i is
    Σ u² / σ² with u = φ(L) b and ∂u/∂φ_k = −L^k b, but as it is information that changes, not variance, the sign
    turns.
    """

    def __init__(self, noise: AutoregressiveNoise, rows: int, whitened: bool) -> None:
        self.noise, self.whitened = noise, whitened
        p = noise.order
        self._states = np.zeros((2, rows, p))
        self._past = np.zeros((rows, p))
        self._sums = np.zeros((rows, p + 1))
        self._samples = 0

    def add(self, rows: FloatArray, usable: FloatArray | float) -> None:
        """Go on with the next samples, zero at those left out, (P, N)."""
        p, polynomial = self.noise.order, self.noise.polynomial
        head = tail = rows
        if p and self.whitened:
            head, self._states[0] = scipy.signal.lfilter(polynomial, [1.0], rows, zi=self._states[0])
            head = head * usable
        elif p:
            head, self._states[0] = scipy.signal.lfilter([1.0], polynomial, rows, zi=self._states[0])
            tail, self._states[1] = scipy.signal.lfilter([1.0], polynomial, head, zi=self._states[1])
        past, count = np.hstack([self._past, tail]), rows.shape[1]
        self._sums[:, 0] += np.einsum("it,it->i", head, head)
        for k in range(1, p + 1):
            self._sums[:, k] += 2.0 * np.einsum("it,it->i", head, past[:, p - k : p - k + count])
        self._past = past[:, past.shape[1] - p :].copy()
        self._samples += count

    def total(self) -> FloatArray:
        """The slopes of all that was added, (P, p + 1)."""
        if not self.whitened:
            self.add(np.zeros((len(self._sums), self.noise.ring(self._samples))), 1.0)
        size = self.noise.variances[-1]
        return np.asarray(self._sums * (1.0 / max(size, TINY) if self.whitened else size))
