"""Doubt about the form of friction: how much other forms may add to the torque, by the residuals of the training."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.checks import FittedLeg
from exoid.checks.sample import few_of, some_samples
from exoid.errors import ExoidError
from exoid.estimate.alternative_friction import COUNT, KINDS, WithAlternatives
from exoid.estimate.model_error import ModelError
from exoid.regression.rows import Rows, chain, decimate, form_rows, prepare
from exoid.signals import Poses, Recording

SIZES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)
"""Prior sizes of an alternative's torque, as parts of the RMS torque of its joint."""

TINY = 1e-12
"""Smallest norm to divide by."""

KEPT = 1e-9
"""Directions whose variance is below this part of the largest are left out."""


def friction_form_error(
    fitted: FittedLeg,
    speed: FloatArray,
    residual_rms: FloatArray,
    independent: FloatArray,
    data: Sequence[Recording | Poses],
) -> ModelError | None:
    """Average over forms of friction that the terms do not have (Bayesian model averaging).

    The candidates are presliding, Stribeck, quadratic and load-dependent friction, each alone and all together. Each
    has coefficients c ~ N(0, s²), with s in :data:`SIZES` (in units of a joint's RMS torque). With X the alternatives'
    weighted rows less what the parameters absorb, and r the weighted residuals, c has the posterior covariance
    S = (XᵀX + s⁻²)⁻¹ and mean S Xᵀr, and the evidence of the candidate is log p = ½ rᵀX S Xᵀr − ½ log|1 + s² XᵀX|.
    Rows count by their share of independent samples. E[c cᵀ] is the mean over candidates, by their evidence.

    Args:
        fitted: Torque model, preparation, parameters, and which of them are known.
        speed: Largest speed of the training [rad/s], (n,).
        residual_rms: RMS residual of each joint [N·m], (n,).
        independent: Independent samples over decimated rows of each joint, (n,).
        data: Recordings and poses.

    Returns:
        The model error; None where no recording in motion gives rows.
    """
    model = WithAlternatives(fitted.model, fitted.values, speed)
    rows = _rows(model, fitted, data)
    if not rows:
        return None
    P, n = len(fitted.values), len(speed)
    usable = np.concatenate([one.usable for one in rows])[..., None]
    every = np.concatenate([one.W for one in rows]) * usable
    tau = np.concatenate([one.tau for one in rows]) * usable[..., 0]
    size = np.sqrt((tau**2).mean(axis=0))
    weights = 1.0 / np.maximum(np.maximum(residual_rms, 1e-9 * size), TINY)
    residual = (tau - every[..., :P] @ fitted.values) * weights
    W = (every[..., :P] * weights[:, None]).reshape(-1, P)
    Z = _spread(every[..., P:] * weights[:, None])
    free = np.isnan(fitted.fixed) & (np.linalg.norm(W, axis=0) > TINY)
    G = np.zeros((P, n * COUNT))
    norms = np.linalg.norm(W[:, free], axis=0)
    G[free] = np.linalg.lstsq(W[:, free] / norms, Z, rcond=1e-7)[0] / norms[:, None]
    share = np.tile(np.sqrt(np.clip(independent, 0.0, 1.0)), len(tau))
    X = (Z - W @ G) * share[:, None]
    scale = np.sqrt((every[..., P:] ** 2).mean(axis=0)).ravel()  # RMS of each alternative before the weights
    unit = np.divide(np.repeat(size, COUNT), scale, out=np.zeros(n * COUNT), where=scale > TINY)
    moment = _average(X.T @ X, X.T @ (residual.ravel() * share), unit, n)
    L = _root(moment, scale * np.repeat(weights, COUNT))
    error = ModelError(speed, -G @ L, L.reshape(n, COUNT, -1), np.zeros(n))
    counted = np.maximum(usable[..., 0].sum(axis=0), 1)
    explained = (error.variance(every) * usable[..., 0]).sum(axis=0) / counted
    return ModelError(error.speed, error.parameters, error.alternatives, explained)


def _rows(model: WithAlternatives, fitted: FittedLeg, data: Sequence[Recording | Poses]) -> list[Rows]:
    """Form decimated rows of recordings in motion, of as many samples as checks look at."""
    found = []
    moving = [one for one in few_of(data) if isinstance(one, Recording)]
    for one in some_samples(fitted.model, moving):
        try:
            prepared = prepare(model, one, fitted.preparation)
        except ExoidError:  # too short for the filter
            continue
        before, kept = 0, []
        for stretch in prepared.stretches():
            kept.append(decimate(form_rows(model, prepared, stretch), before, len(prepared.rows)))
            before += len(stretch)
        found.append(chain([rows for rows in kept if len(rows.time)]))
    return found


def _spread(own: FloatArray) -> FloatArray:
    """Give each joint's columns (N, n, K) a place of their own, (N n, n K)."""
    N, n, K = own.shape
    out = np.zeros((N, n, n, K))
    for j in range(n):
        out[:, j, j] = own[:, j]
    return out.reshape(N * n, n * K)


def _average(H: FloatArray, h: FloatArray, unit: FloatArray, joints: int) -> FloatArray:
    """Average the second moment E[c cᵀ] over all candidates.

    Args:
        H: XᵀX, (n K, n K).
        h: Xᵀr, (n K,).
        unit: Coefficient of each alternative whose torque has the RMS of that of its joint, (n K,).
        joints: Number n of joints.

    Returns:
        Second moment, (n K, n K).
    """
    moments, evidence = [], []
    for columns in (*KINDS.values(), tuple(range(COUNT))):
        chosen = np.flatnonzero(np.tile(np.isin(np.arange(COUNT), columns), joints) & (unit > 0.0))
        for size in SIZES:
            scale = size * unit[chosen]
            sizes, vectors = np.linalg.eigh(scale[:, None] * H[np.ix_(chosen, chosen)] * scale)
            sizes = 1.0 + np.clip(sizes, 0.0, None)
            mean = vectors @ (vectors.T @ (scale * h[chosen]) / sizes)
            evidence.append(0.5 * float(scale * h[chosen] @ mean - np.log(sizes).sum()))
            whole = np.zeros_like(H)
            inner = (vectors / sizes) @ vectors.T + np.multiply.outer(mean, mean)
            whole[np.ix_(chosen, chosen)] = scale[:, None] * inner * scale
            moments.append(whole)
    weights = np.exp(np.array(evidence) - max(evidence))
    return np.asarray(np.tensordot(weights / weights.sum(), np.array(moments), axes=1))


def _root(moment: FloatArray, scale: FloatArray) -> FloatArray:
    """L with L Lᵀ = E[c cᵀ], without directions that hardly matter in units of the residuals, (n K, r)."""
    scale = np.where(scale > TINY, scale, 1.0)
    sizes, vectors = np.linalg.eigh(scale[:, None] * moment * scale)
    kept = sizes > KEPT * max(sizes[-1], TINY)
    return np.asarray((vectors[:, kept] * np.sqrt(sizes[kept])) / scale[:, None])
