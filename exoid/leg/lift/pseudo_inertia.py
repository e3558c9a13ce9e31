"""Pseudo-inertias: 4 × 4 matrices that are positive definite if and only if a body is physically consistent.

With Σ = ∫ r rᵀ dm the second moment, mc the first and m the mass of a body, P = [[Σ, mc], [mcᵀ, m]]. A distribution of
positive mass has P ≻ 0, and every P ≻ 0 has one. Positive mass and principal inertias and the triangle inequalities
follow (P. M. Wensing, S. Kim, J.-J. E. Slotine, IEEE RA-L 3(1), 2018).
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

BASIS = np.array([pin.PseudoInertia.FromDynamicParameters(unit).toMatrix() for unit in np.eye(10)])
"""Pseudo-inertia of each unit link parameter, (10, 4, 4): P = Σ π_k BASIS_k."""

COORDINATES = np.linalg.pinv(BASIS.reshape(10, 16).T)
"""Link parameters π of a flattened pseudo-inertia, (10, 16)."""

SMALLEST_RADIUS = 1e-2
"""Smallest radius of gyration in any direction that a repaired body gets [m]."""

THINNEST = 1e-3
"""Smallest second moment that a repaired body gets, over its largest."""


def pseudo_inertias(link_parameters: FloatArray) -> FloatArray:
    """Compute the pseudo-inertia P of each link."""
    return np.tensordot(np.reshape(link_parameters, (-1, 10)), BASIS, 1)


def link_parameters(pseudo_inertias: FloatArray) -> FloatArray:
    """Compute link parameters π: the inverse of :func:`pseudo_inertias`."""
    return np.ravel(np.reshape(pseudo_inertias, (-1, 16)) @ COORDINATES.T)


def margins(link_parameters: FloatArray) -> FloatArray:
    """Compute the margin of physical consistency: the smallest eigenvalue of P scaled to a unit diagonal."""
    P = pseudo_inertias(link_parameters)
    diagonal = np.diagonal(P, axis1=1, axis2=2)
    positive = (diagonal > 0.0).all(axis=1)
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    smallest = np.linalg.eigvalsh(P / scale[:, :, None] / scale[:, None, :])[:, 0]
    return np.where(positive, smallest, -np.inf)


def make_consistent(link_parameters: FloatArray) -> FloatArray:
    """Give bodies without a mass distribution, such as point masses or rods, a small extent."""
    # Mass and centre of mass do not change. Principal second moments about the centre of mass grow to at least
    # m · `SMALLEST_RADIUS`² and `THINNEST` times the largest.
    repaired = np.reshape(link_parameters, (-1, 10)).copy()
    # Smallest margin of a consistent body, beyond rounding
    for k in np.flatnonzero(margins(link_parameters) < 1e-8):
        P = pseudo_inertias(repaired[k])[0]
        mass, moment = P[3, 3], P[:3, 3]
        values, axes = np.linalg.eigh(P[:3, :3] - np.outer(moment, moment) / mass)
        least = max(THINNEST * values[-1], mass * SMALLEST_RADIUS**2)
        P[:3, :3] += (axes * np.maximum(least - values, 0.0)) @ axes.T
        repaired[k, 4:] = (P.ravel() @ COORDINATES.T)[4:]
    return repaired.ravel()


def congruence(A: FloatArray) -> FloatArray:
    """Compute matrices T with π(A P Aᵀ) = T π(P), which move mass by affine maps."""
    moved = A[:, None] @ BASIS @ A[:, None].transpose(0, 1, 3, 2)
    return np.asarray(COORDINATES @ moved.reshape(-1, 10, 16).transpose(0, 2, 1))


def upper_factors(P: FloatArray) -> FloatArray:
    """Factorise P = U Uᵀ with U upper triangular, as in the log-Cholesky parameterisation."""
    return np.asarray(np.linalg.cholesky(P[:, ::-1, ::-1])[:, ::-1, ::-1], dtype=np.float64)
