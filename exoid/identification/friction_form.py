"""Doubt about the form of friction: how much other forms may add to the torque, by the residuals of the training."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate.model_error import COUNT, KINDS, ModelError
from exoid.regression.diagnostics import JointNoise
from exoid.regression.least_squares import scaled_inverse
from exoid.regression.residuals import matrix_root
from exoid.regression.row_data import Rows

from .findings.checkup import Checkup
from .findings.sample import FittedLeg

SMALLEST = 1e-12  # norm to divide by


def friction_form_error(
    fitted: FittedLeg, checkup: Checkup, residual_rms: FloatArray, noise: Sequence[JointNoise]
) -> ModelError | None:
    """Average over forms of friction that the terms do not have (Bayesian model averaging)."""
    # The candidates are presliding, Stribeck, quadratic and load-dependent friction, each alone and all together. Each
    # has coefficients c ~ N(0, s²), with s from 1e-4 to 0.1 of a joint's RMS torque. With X the alternatives'
    # weighted rows less what the parameters absorb, and r the weighted residuals, c has the posterior covariance
    # S = (XᵀX + s⁻²)⁻¹ and mean S Xᵀr, and the evidence of the candidate is log p = ½ rᵀX S Xᵀr − ½ log|1 + s² XᵀX|.
    # Rows count by their share of independent samples. E[c cᵀ] is the mean over candidates, by their evidence.
    if checkup.ranges is None or not checkup.moving:
        return None
    speed, columns = checkup.ranges.speed, np.r_[: len(fitted.values), -COUNT:0]
    rows = [one._replace(W=one.W[..., columns]) for one in checkup.moving]
    joints = [_Joint.of(rows, j, fitted.values, float(residual_rms[j])) for j in range(len(speed))]
    WW = np.asarray(sum(joint.W.T @ joint.W for joint in joints))
    G = np.hstack([joint.W.T @ joint.Z for joint in joints])  # alternatives that free parameters absorb, (P, n K)
    used = np.isnan(fitted.fixed) & (np.diag(WW) > SMALLEST)
    G[used], G[~used] = scaled_inverse(WW[np.ix_(used, used)]) @ G[used], 0.0
    H, h = np.zeros((G.shape[1],) * 2), np.zeros(G.shape[1])
    for j, (joint, of_joint) in enumerate(zip(joints, noise, strict=True)):
        X = -joint.W @ G
        X[:, j * COUNT : (j + 1) * COUNT] += joint.Z
        share = min(max(of_joint.effective_samples / max(of_joint.samples, 1), 0.0), 1.0)
        H += share * X.T @ X
        h += share * X.T @ joint.residual
    L = matrix_root(_average(H, h, np.concatenate([joint.unit for joint in joints]), len(joints)))
    error = ModelError(speed, -G @ L, L.reshape(len(joints), COUNT, -1), np.zeros(len(joints)))
    count = np.maximum(sum(one.usable.sum(axis=0) for one in rows), 1)
    explained = sum((error.variance(one.W) * one.usable).sum(axis=0) for one in rows) / count
    return ModelError(error.speed, error.parameters, error.alternatives, explained)


class _Joint(NamedTuple):
    """Weighted rows of one joint: those of the parameters W (N, P), alternatives Z (N, K), residuals r (N,)."""

    W: FloatArray  # columns of the parameters
    Z: FloatArray  # columns of the alternatives
    residual: FloatArray  # residuals
    # coefficient of each alternative whose torque has the RMS of that of the joint, (K,); 0 for one without
    unit: FloatArray

    @staticmethod
    def of(rows: Sequence[Rows], j: int, values: FloatArray, residual_rms: float) -> _Joint:
        """Take the usable rows of a joint, over the RMS residual."""
        columns = np.concatenate([one.W[one.usable[:, j], j] for one in rows])
        tau = np.concatenate([one.tau[one.usable[:, j], j] for one in rows])
        size = float(np.sqrt(np.mean(tau**2))) if len(tau) else 0.0
        weight = 1.0 / max(residual_rms, 1e-9 * size, SMALLEST)
        W, Z = columns[:, : len(values)], columns[:, len(values) :]
        scale = np.sqrt((Z**2).sum(axis=0) / max(len(Z), 1))
        unit = np.divide(size, scale, out=np.zeros(len(scale)), where=scale > SMALLEST)
        return _Joint(weight * W, weight * Z, weight * (tau - W @ values), unit)


def _average(H: FloatArray, h: FloatArray, unit: FloatArray, joints: int) -> FloatArray:
    """Average the second moment E[c cᵀ] over all candidates."""
    # prior sizes of an alternative's torque, as parts of the RMS torque of its joint
    sizes, spectra, evidence = np.array([1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1])[:, None], [], []
    for columns in (*KINDS.values(), tuple(range(COUNT))):
        chosen = np.flatnonzero(np.tile(np.isin(np.arange(COUNT), columns), joints) & (unit > 0.0))
        scale = unit[chosen]
        squares, vectors = np.linalg.eigh(scale[:, None] * H[np.ix_(chosen, chosen)] * scale)
        shrunk = sizes**2 / (1.0 + sizes**2 * np.clip(squares, 0.0, None))  # eigenvalues of S in units of the torque
        turned = vectors.T @ (scale * h[chosen])
        spectra.append((chosen, scale[:, None] * vectors, shrunk, shrunk * turned))
        evidence.append(0.5 * (shrunk @ turned**2 + np.log(shrunk / sizes**2).sum(axis=1)))
    weights = np.exp(np.array(evidence) - np.max(evidence))
    total = np.zeros_like(H)
    for of_kind, (chosen, vectors, shrunk, means) in zip(weights / weights.sum(), spectra, strict=True):
        inner = np.diag(of_kind @ shrunk) + (means.T * of_kind) @ means
        total[np.ix_(chosen, chosen)] += vectors @ inner @ vectors.T
    return total
