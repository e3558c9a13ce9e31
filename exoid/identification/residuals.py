"""Residuals in time order, what noise they show, and the covariance of an estimate under that noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .noise import LARGEST_ORDER, AutoregressiveNoise, autocovariance_sums
from .problem import Kind, Problem

PASSES = 5
"""Noise and covariance depend on each other, and are computed in turn at most so often."""

SETTLED = 1e-3
"""They have converged when no standard deviation changes by more than this part."""


class Series(NamedTuple):
    """Weighted rows of one recording and joint in time order.

    Attributes:
        kind: Of the noise.
        joint: Index.
        columns: Parameters that act on the joint, (p,).
        X: Their columns of the regressor, zero at samples left out, (p, N).
        residual: τ − W β, zero there too, (N,).
        usable: Samples not left out, (N,).
        stands_for: How many rows each of these stands for.
    """

    kind: Kind
    joint: int
    columns: NDArray[np.intp]
    X: FloatArray
    residual: FloatArray
    usable: FloatArray
    stands_for: float


class Point(NamedTuple):
    """Parameters and how the rows that gave them were weighted.

    Attributes:
        values: β, (P,).
        weights: Of each triangle's rows, by which their residuals are of size 1.
        clip: Weighted residuals beyond this counted as this; infinite for least squares.
    """

    values: FloatArray
    weights: Sequence[float]
    clip: float = np.inf


Noises = Mapping[tuple[Kind, int], AutoregressiveNoise]
"""Noise of each kind and joint, in units of the weighted rows."""


def series(problem: Problem, point: Point) -> Iterator[Series]:
    """Go over all recordings and joints, in rows thinned to the pace of independent noise."""
    for kind, rows in problem.blocks(thinned=True):
        for joint in range(rows.tau.shape[1]):
            weight = point.weights[problem.weight_index(kind, joint)]
            usable = rows.usable[:, joint].astype(np.float64)
            W = rows.W[:, joint].T
            columns = np.flatnonzero(W.any(axis=1))
            X = weight * W[columns] * usable
            residual = weight * rows.tau[:, joint] * usable - point.values[columns] @ X
            residual = np.clip(residual, -point.clip, point.clip)
            yield Series(kind, joint, columns, X, residual, usable, rows.stands_for)


def fit_noise(problem: Problem, point: Point, covariance: FloatArray) -> dict[tuple[Kind, int], AutoregressiveNoise]:
    """Fit an autoregressive model to the residuals of each kind and joint.

    Residuals are smaller than the noise, and less alike, since the fit has taken part of it away; on average
    γ̂_k falls short by (1/N) Σ_t x_t C x_{t+k}ᵀ with C the covariance of the estimate, which is put back (as restricted
    maximum likelihood does). Samples left out do not count.
    """
    sums: dict[tuple[Kind, int], FloatArray] = {}
    for part in series(problem, point):
        largest = 0 if part.kind.at_rest else max(0, min(LARGEST_ORDER, int(part.usable.sum()) // 10))
        found = np.zeros((2, LARGEST_ORDER + 1))
        root = _root(covariance[np.ix_(part.columns, part.columns)])
        found[0, : largest + 1] = autocovariance_sums(part.residual, largest)
        found[0, : largest + 1] += autocovariance_sums(root.T @ part.X, largest)
        found[1, : largest + 1] = np.rint(autocovariance_sums(part.usable, largest))
        key = (part.kind, part.joint)
        sums[key] = sums.get(key, np.zeros_like(found)) + found
    return {key: _model(*found) for key, found in sums.items()}


class Sandwich(NamedTuple):
    """Covariance of a weighted least-squares estimate under correlated noise.

    Attributes:
        covariance: (P, P).
        noises: The noise it is for.
    """

    covariance: FloatArray
    noises: Noises


def sandwich(problem: Problem, point: Point, inverse: FloatArray, start: FloatArray) -> Sandwich:
    """Compute (WᵀW)⁻¹ Wᵀ Γ W (WᵀW)⁻¹ with Γ that of the autoregressive noise in the residuals.

    Args:
        problem: The problem.
        point: Where it was solved.
        inverse: (WᵀW)⁻¹ of the weighted rows.
        start: A first idea of the covariance.
    """
    covariance = start
    for _ in range(PASSES):
        noises = fit_noise(problem, point, covariance)
        meat = np.zeros_like(inverse)
        for part in series(problem, point):
            form = noises[part.kind, part.joint].quadratic_form(part.X)
            meat[np.ix_(part.columns, part.columns)] += part.stands_for**2 * form
        before, covariance = covariance, inverse @ meat @ inverse
        if settled(before, covariance):
            break
    return Sandwich(0.5 * (covariance + covariance.T), noises)


def settled(before: FloatArray, covariance: FloatArray) -> bool:
    """Say whether standard deviations have stopped changing."""
    old, new = np.sqrt(np.diag(before)), np.sqrt(np.diag(covariance))
    return bool((np.abs(old - new) <= SETTLED * new).all())


def _model(products: FloatArray, pairs: FloatArray) -> AutoregressiveNoise:
    """Noise of autocovariances Σ e_t e_{t+k} / pairs_k, tapered by 1 − k/N as if no sample were left out."""
    if pairs[0] <= 0.0:
        return AutoregressiveNoise.none()
    known = int(np.argmin(np.append(pairs, 0.0) > 0.0))  # up to the first lag without a pair
    samples = pairs[0]
    taper = np.clip(1.0 - np.arange(known) / samples, 0.0, None)
    return AutoregressiveNoise.from_autocovariances(products[:known] / pairs[:known] * taper, samples)


def _root(covariance: FloatArray) -> FloatArray:
    """L with L Lᵀ = C, whatever rounding has done to C."""
    sizes, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.clip(sizes, 0.0, None)))
