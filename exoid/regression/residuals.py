"""Residuals in time order, what noise they show, and the covariance of an estimate under that noise."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .least_squares import Solution
from .noise import LARGEST_ORDER, AutoregressiveNoise, LagSums, QuadraticForm
from .problem import RowSource
from .row_data import NoiseKind, RowBlock


class Series(NamedTuple):
    """Weighted rows of one recording and joint in time order, or a stretch of them."""

    kind: NoiseKind  # kind of the noise
    joint: int  # index
    columns: NDArray[np.intp]  # parameters that act on the joint, (p,)
    X: FloatArray  # their columns of the regressor, zero at samples left out, (p, N)
    residual: FloatArray  # τ − W β, zero there too, (N,)
    usable: FloatArray  # samples not left out, (N,)
    stands_for: float  # number of rows that each of these stands for
    begins: bool = True  # whether these are the first of the recording
    ends: bool = True  # whether these are the last of it


class Point(NamedTuple):
    """Parameters and how the rows that gave them were weighted."""

    values: FloatArray  # β, (P,)
    weights: Sequence[float]  # weight of the rows of each R factor; weighted residuals are of size 1
    # limit of weighted residuals, beyond which they count as the limit; infinite for least squares
    clip: float = np.inf


Noises = Mapping[tuple[NoiseKind, int], AutoregressiveNoise]
"""Noise of each kind and joint, in units of the weighted rows."""


def series(rows: RowSource, point: Point) -> Iterator[Iterator[Series]]:
    """Go over the rows of each recording, joint by joint, decimated to the pace of independent noise."""
    weights = [
        [point.weights[rows.weight_index(NoiseKind(at_rest, 0), joint)] for at_rest in (False, True)]
        for joint in range(len(rows.columns))
    ]
    for blocks in rows.recordings():
        yield _weigh(rows.columns, weights, point, blocks)


def _weigh(
    columns_of: Sequence[NDArray[np.intp]], weights: Sequence[Sequence[float]], point: Point, blocks: Iterable[RowBlock]
) -> Iterator[Series]:
    """Weigh rows joint by joint, with the weight of each joint in motion and at rest."""
    for kind, rows, begins, ends, first in blocks:
        for own, acting in enumerate(rows.acting):
            joint = first + own
            usable, columns = rows.usable[:, own].astype(np.float64), columns_of[joint]
            counted = weights[joint][kind.at_rest] * usable
            X = rows.W[:, own].T[acting]
            X *= counted
            residual = rows.tau[:, own] * counted - point.values[columns] @ X
            if np.isfinite(point.clip):
                residual = np.clip(residual, -point.clip, point.clip)
            yield Series(kind, joint, columns, X, residual, usable, rows.stands_for, begins, ends)


def fit_noise(
    problem: RowSource, point: Point, covariance: FloatArray
) -> dict[tuple[NoiseKind, int], AutoregressiveNoise]:
    """Fit an autoregressive model to the residuals of each kind and joint."""
    # Residuals are smaller than the noise, and less alike, since the fit has taken part of it away; on average
    # γ̂_k falls short by (1/N) Σ_t x_t C x_{t+k}ᵀ with C the covariance of the estimate, which is put back (as
    # restricted maximum likelihood does). Samples left out do not count.
    roots = [matrix_root(covariance[np.ix_(columns, columns)]).T for columns in problem.columns]
    sums: dict[tuple[NoiseKind, int], FloatArray] = {}
    for parts in series(problem, point):
        for key, of_joint in _lag_sums(roots, parts).items():
            sums[key] = sums.get(key, 0.0) + of_joint
    return {key: _model(*found) for key, found in sums.items()}


def _lag_sums(roots: Sequence[FloatArray], parts: Iterator[Series]) -> dict[tuple[NoiseKind, int], FloatArray]:
    """Sums of products of residuals and what the fit has taken, and of pairs of usable samples, by lag, (2, K + 1)."""
    sums: dict[tuple[NoiseKind, int], FloatArray] = {}
    running: dict[int, tuple[LagSums, LagSums]] = {}
    for part in parts:
        if part.begins:
            running[part.joint] = (LagSums(LARGEST_ORDER), LagSums(LARGEST_ORDER))
        products, pairs = running[part.joint]
        products.add(np.vstack([part.residual, roots[part.joint] @ part.X]))
        pairs.add(part.usable)
        if part.ends:
            found = np.array([products.sums, np.rint(pairs.sums)])
            if part.kind.at_rest:
                found[:, 1:] = 0.0
            sums[part.kind, part.joint] = found
    return sums


class Sandwich(NamedTuple):
    """Covariance of a weighted least-squares estimate under correlated noise."""

    covariance: FloatArray  # (P, P)
    noises: Noises  # the noise it is for


def sandwich(problem: RowSource, point: Point, solution: Solution) -> Sandwich:
    """Compute (WᵀW)⁻¹ Wᵀ Γ W (WᵀW)⁻¹ with Γ that of the autoregressive noise in the residuals."""
    # Rows of priors are among those of W, with the noise that the priors say.
    inverse, covariance = solution.inverse, solution.covariance
    for _ in range(5):  # noise and covariance depend on each other, and are computed in turn
        noises = fit_noise(problem, point, covariance)
        meat = solution.prior_noise.copy()
        for parts in series(problem, point):
            meat += _meat(noises, len(meat), parts)
        half = inverse @ matrix_root(meat)  # so that no variance is negative, however ill-conditioned the rows
        before, covariance = covariance, half @ half.T
        if settled(before, covariance):
            break
    return Sandwich(covariance, noises)


def _meat(noises: Noises, count: int, parts: Iterator[Series]) -> FloatArray:
    """Wᵀ Γ W of one recording."""
    meat = np.zeros((count, count))
    running: dict[int, QuadraticForm] = {}
    for part in parts:
        if part.begins:
            running[part.joint] = QuadraticForm(noises[part.kind, part.joint], len(part.columns))
        running[part.joint].add(part.X)
        if part.ends:
            meat[np.ix_(part.columns, part.columns)] += part.stands_for**2 * running[part.joint].total()
    return meat


def settled(before: FloatArray, covariance: FloatArray) -> bool:
    """Say whether no standard deviation changes by more than a thousandth."""
    old, new = np.sqrt(np.diag(before)), np.sqrt(np.diag(covariance))
    return bool((np.abs(old - new) <= 1e-3 * new).all())


def _model(products: FloatArray, pairs: FloatArray) -> AutoregressiveNoise:
    """Noise of autocovariances Σ e_t e_{t+k} / pairs_k, tapered by 1 − k/N as if no sample were left out."""
    # Lags up to N/10 count, and up to the first without a pair, which short recordings or segments do not have.
    if pairs[0] <= 0.0:
        return AutoregressiveNoise.none()
    samples, run = pairs[0], int(np.argmin(np.append(pairs, 0.0) > 0.0))
    known = min(len(pairs), 1 + int(samples) // 10)
    longest_run, known = (run, run) if run < known else (None, known)
    taper = np.clip(1.0 - np.arange(known) / samples, 0.0, None)
    model = AutoregressiveNoise.from_autocovariances(products[:known] / pairs[:known] * taper, samples)
    return replace(model, longest_run=longest_run)


def matrix_root(covariance: FloatArray) -> FloatArray:
    """L with L Lᵀ = C, whatever rounding has done to C, and whatever the units."""
    scale = np.sqrt(np.clip(np.diag(covariance), 1e-300, None))
    sizes, vectors = np.linalg.eigh(covariance / np.multiply.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.clip(sizes, 0.0, None)))
