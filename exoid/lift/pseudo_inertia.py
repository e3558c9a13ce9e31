"""Pseudo-inertias: the 4 × 4 matrices whose positive definiteness is what makes a rigid body possible.

With Σ = ∫ r rᵀ dm the second moment, mc the first and m the mass of a body, P = [[Σ, mc], [mcᵀ, m]]. A distribution of
positive mass has P ≻ 0, and every P ≻ 0 has one: mass, principal inertias and R factor inequalities all follow
(P. M. Wensing, S. Kim, J.-J. E. Slotine, IEEE RA-L 3(1), 2018).
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

BASIS = np.array([pin.PseudoInertia.FromDynamicParameters(unit).toMatrix() for unit in np.eye(10)])
"""Pseudo-inertia of each unit link parameter, (10, 4, 4): P = Σ π_k BASIS_k."""

COORDINATES = np.linalg.pinv(BASIS.reshape(10, 16).T)
"""Link parameters π of a flattened pseudo-inertia, (10, 16)."""

BARELY = 1e-8
"""Margin below which a body cannot exist, but for rounding."""

SMALLEST_RADIUS = 1e-2
"""Radius of gyration that such a body gets at least in every direction [m]."""

THINNEST = 1e-3
"""Nor does it get thinner than this fraction of its largest second moment."""


def pseudo_inertias(link_parameters: FloatArray) -> FloatArray:
    """Pseudo-inertia P of each link, given π of all links, (10 n,) or (n, 10).

    Returns:
        P, (n, 4, 4).
    """
    return np.tensordot(np.reshape(link_parameters, (-1, 10)), BASIS, 1)


def link_parameters(pseudo_inertias: FloatArray) -> FloatArray:
    """Link parameters π of pseudo-inertias, (n, 4, 4); the inverse of :func:`pseudo_inertias`, (10 n,)."""
    return np.ravel(np.reshape(pseudo_inertias, (-1, 16)) @ COORDINATES.T)


def margins(link_parameters: FloatArray) -> FloatArray:
    """How far each body is from impossible: the smallest eigenvalue of P scaled to a diagonal of ones, (n,).

    Positive for a body that can exist, at most 1; −inf where the mass or a second moment is not positive.
    """
    P = pseudo_inertias(link_parameters)
    diagonal = np.diagonal(P, axis1=1, axis2=2)
    possible = (diagonal > 0.0).all(axis=1)
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    smallest = np.linalg.eigvalsh(P / scale[:, :, None] / scale[:, None, :])[:, 0]
    return np.where(possible, smallest, -np.inf)


def made_possible(link_parameters: FloatArray) -> FloatArray:
    """Repair bodies that no mass distribution has, such as point masses or rods: they gain a little extent.

    Mass and centre of mass stay. Principal second moments about the centre of mass grow to at least
    m · :data:`SMALLEST_RADIUS`² and :data:`THINNEST` times the largest.

    Args:
        link_parameters: π, (10 n,), of bodies with positive mass.

    Returns:
        π, (10 n,), in which bodies that can exist are unchanged.
    """
    repaired = np.reshape(link_parameters, (-1, 10)).copy()
    for k in np.flatnonzero(margins(link_parameters) < BARELY):
        P = pseudo_inertias(repaired[k])[0]
        mass, moment = P[3, 3], P[:3, 3]
        values, axes = np.linalg.eigh(P[:3, :3] - np.outer(moment, moment) / mass)
        least = max(THINNEST * values[-1], mass * SMALLEST_RADIUS**2)
        P[:3, :3] += (axes * np.maximum(least - values, 0.0)) @ axes.T
        repaired[k, 4:] = (P.ravel() @ COORDINATES.T)[4:]
    return repaired.ravel()


def congruence(A: FloatArray) -> FloatArray:
    """Matrices T with π(A P Aᵀ) = T π(P), (n, 10, 10): mass moved by the affine maps A, (n, 4, 4)."""
    moved = A[:, None] @ BASIS @ A[:, None].transpose(0, 1, 3, 2)
    return np.asarray(COORDINATES @ moved.reshape(-1, 10, 16).transpose(0, 2, 1))


def upper_factors(P: FloatArray) -> FloatArray:
    """Upper triangular U with U Uᵀ = P, (n, 4, 4), as the log-Cholesky parameterisation has them."""
    return np.asarray(np.linalg.cholesky(P[:, ::-1, ::-1])[:, ::-1, ::-1], dtype=np.float64)
