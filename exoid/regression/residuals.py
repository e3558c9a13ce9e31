"""Residuals in time order, what noise they show, and the covariance of an estimate under that noise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .noise import LARGEST_ORDER, AutoregressiveNoise, autocovariance_sums
from .problem import Fit, RowSource, Uncertainty
from .row_data import NoiseKind


class Series(NamedTuple):
    """Weighted rows of one recording and joint in time order."""

    kind: NoiseKind  # kind of the noise
    joint: int  # index
    columns: NDArray[np.intp]  # parameters that act on the joint, (p,)
    X: FloatArray  # their columns of the regressor, zero at samples left out, (p, N)
    residual: FloatArray  # τ − W β, zero there too, (N,)
    usable: FloatArray  # samples not left out, (N,)
    stands_for: float  # number of rows that each of these stands for


def series(source: RowSource, fit: Fit) -> Iterator[list[Series]]:
    """Go over the recordings: weighted rows of each joint, decimated to the pace of independent noise."""
    for kind, rows, first in source.recordings():
        parts = []
        for own, joint in enumerate(range(first, first + rows.tau.shape[1])):
            usable, columns = rows.usable[:, own].astype(np.float64), source.columns[joint]
            counted = fit.weights[source.weight_index(kind, joint)] * usable
            X = rows.W[:, own].T[rows.acting[own]]
            X *= counted
            residual = rows.tau[:, own] * counted - fit.solution.values[columns] @ X
            if np.isfinite(fit.clip):
                residual = np.clip(residual, -fit.clip, fit.clip)
            parts.append(Series(kind, joint, columns, X, residual, usable, rows.stands_for))
        yield parts


def fit_noise(problem: RowSource, fit: Fit, covariance: FloatArray) -> dict[tuple[NoiseKind, int], AutoregressiveNoise]:
    """Fit an autoregressive model to the residuals of each kind and joint."""
    # Residuals are smaller than the noise, and less alike, since the fit has taken part of it away; on average
    # γ̂_k falls short by (1/N) Σ_t x_t C x_{t+k}ᵀ with C the covariance of the estimate, which is put back (as
    # restricted maximum likelihood does). Samples left out do not count.
    roots = [matrix_root(covariance[np.ix_(columns, columns)]).T for columns in problem.columns]
    sums: dict[tuple[NoiseKind, int], FloatArray] = {}
    for part in (part for parts in series(problem, fit) for part in parts):
        products = autocovariance_sums(np.vstack([part.residual, roots[part.joint] @ part.X]), LARGEST_ORDER)
        found = np.array([products, np.rint(autocovariance_sums(part.usable, LARGEST_ORDER))])
        if part.kind.at_rest:
            found[:, 1:] = 0.0
        sums[part.kind, part.joint] = sums.get((part.kind, part.joint), 0.0) + found
    noises = {}
    for key, (products, pairs) in sums.items():
        if pairs[0] <= 0.0:
            noises[key] = AutoregressiveNoise.none()
            continue
        # Lags up to N/10 count, and up to the first without a pair, which short recordings or segments do not have.
        samples, run = pairs[0], int(np.argmin(np.append(pairs, 0.0) > 0.0))
        known = min(len(pairs), 1 + int(samples) // 10)
        longest_run, known = (run, run) if run < known else (None, known)
        taper = np.clip(1.0 - np.arange(known) / samples, 0.0, None)  # as if no sample were left out
        noise = AutoregressiveNoise.from_autocovariances(products[:known] / pairs[:known] * taper, samples)
        noises[key] = replace(noise, longest_run=longest_run)
    return noises


def sandwich(problem: RowSource, fit: Fit) -> Uncertainty:
    """Compute (WᵀW)⁻¹ Wᵀ Γ W (WᵀW)⁻¹ with Γ that of the autoregressive noise in the residuals."""
    # Rows of priors are among those of W, with the noise that the priors say.
    inverse, covariance = fit.solution.inverse, fit.solution.covariance
    for _ in range(5):  # noise and covariance depend on each other, and are computed in turn
        noises = fit_noise(problem, fit, covariance)
        meat = fit.solution.prior_noise.copy()
        for part in (part for parts in series(problem, fit) for part in parts):
            of_rows = noises[part.kind, part.joint].quadratic_form(part.X)
            meat[np.ix_(part.columns, part.columns)] += part.stands_for**2 * of_rows
        half = inverse @ matrix_root(meat)  # so that no variance is negative, however ill-conditioned the rows
        before, covariance = covariance, half @ half.T
        old, new = np.sqrt(np.diag(before)), np.sqrt(np.diag(covariance))
        if (np.abs(old - new) <= 1e-3 * new).all():
            break
    return Uncertainty(covariance, None, noises)


def matrix_root(covariance: FloatArray) -> FloatArray:
    """L with L Lᵀ = C, whatever rounding has done to C, and whatever the units."""
    scale = np.sqrt(np.clip(np.diag(covariance), 1e-300, None))
    sizes, vectors = np.linalg.eigh(covariance / np.multiply.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.clip(sizes, 0.0, None)))
