"""Combinations of rows on which links on the ground do no work (Aghili 2005; Mistry et al. 2010)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.leg import Leg

POSES = 5
"""Random poses of which the independent constraints are counted."""

ALIGNED = 0.2
"""Least part of each axis of closed chains that is left in the directions in which a sample can move."""


class Elimination(NamedTuple):
    """Combinations of rows that links on the ground do no work on, Zᵀ J_cᵀ = 0."""

    # motion −K of the base per rate of each joint while the first link rests, K (N, b, n); None without base
    # rows
    lever: FloatArray | None
    # Z of joint rows: rates of the joints at which the other links rest too, orthonormal, (N, n, r); None for
    # one link, which leaves every joint free
    loop: FloatArray | None
    fit: NDArray[np.bool_]  # whether Z is well defined, (N,)

    def of(self, rows: FloatArray) -> FloatArray:
        """Combine rows."""
        base = 0 if self.lever is None else self.lever.shape[1]
        out = rows[:, base:].copy()
        if self.lever is not None:
            for k, of_row in enumerate(self.lever.transpose(1, 2, 0)):
                for joint, share in enumerate(of_row):
                    if share.any():
                        out[:, joint] -= share * rows[:, k]
        return out if self.loop is None else np.einsum("kjn,njs->ksn", out, self.loop)


def eliminate(leg: Leg, links: Sequence[str], q: FloatArray, axes: FloatArray | None = None) -> Elimination:
    """Find the rows that unknown wrenches on links leave."""
    # The first link fixes the base: ν_b = −K q̇ with K = J_b⁻¹ J_q. Each further link has J_q − J_b K = C with
    # C q̇ = 0. Joint rates that fulfil it are the null space of C, with the projector P. Their basis Z = P E
    # (Eᵀ P E)^(−1/2) varies smoothly, and is orthonormal, so that each row has the noise of one joint's torque.
    # Constraints and their forces are those of Featherstone (2008, ch. 8), the projector that of Aghili (2005).
    # Mistry et al. (2010) find such rows by QR of J_cᵀ; all choices span the same space (Righetti et al. 2011).
    fit = np.ones(len(q), dtype=np.bool_)
    lever, C = _constraints(leg, links, q)
    if C is None:
        return Elimination(lever, None, fit)
    _, sizes, Vt = np.linalg.svd(C)
    rank = _rank(leg, links)
    # Least singular value of the constraints of a sample that is used: at a straight knee a foot can hardly
    # move up
    fit &= sizes[:, rank - 1] > 0.03 * sizes[:, 0]
    free = Vt[:, rank:]
    P = np.swapaxes(free, 1, 2) @ free
    E = _reference(P[fit] if fit.any() else P, P.shape[1] - rank) if axes is None else axes
    loop, aligned = _orthonormal(P, E)
    return Elimination(lever, loop, fit & aligned)


def load_sharing(loop: FloatArray, axes: FloatArray) -> FloatArray:
    """Find the directions of joint rows in which links share loads: all but those of closed chains, (N, n, n − r)."""
    P = np.eye(len(axes)) - loop @ np.swapaxes(loop, 1, 2)
    return _orthonormal(P, scipy.linalg.null_space(axes.T))[0]


def _orthonormal(P: FloatArray, E: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Project axes, P E (Eᵀ P E)^(−1/2), and tell where enough of each axis is left."""
    PE = P @ E
    parts, turns = np.linalg.eigh(E.T @ PE)
    roots = (turns / np.sqrt(np.maximum(parts, ALIGNED))[:, None, :]) @ np.swapaxes(turns, 1, 2)
    return PE @ roots, parts.min(axis=1, initial=1.0) > ALIGNED


def _constraints(leg: Leg, links: Sequence[str], q: FloatArray) -> tuple[FloatArray | None, FloatArray | None]:
    """Form K of the first link, and C of the others; None for what there is not."""
    base = leg.base_rows
    jacobians = [leg.contact_jacobian(q, link) for link in links]
    lever: FloatArray | None = None
    if base:
        first = jacobians.pop(0)
        lever = np.asarray(np.linalg.solve(first[..., :base], first[..., base:]), dtype=np.float64)
        jacobians = [each[..., base:] - each[..., :base] @ lever for each in jacobians]
    return lever, np.concatenate(jacobians, axis=1) if jacobians else None


def _rank(leg: Leg, links: Sequence[str]) -> int:
    """Number of independent constraints of closed chains in a pose without symmetries."""
    poses = np.random.default_rng(0).standard_normal((POSES, len(leg.joint_names)))
    _, C = _constraints(leg, links, poses)
    assert C is not None
    # Singular values of the constraints below this part of the largest are those of directions that cannot move
    # anyway
    return int(np.linalg.matrix_rank(C, rtol=1e-6).max())


def reference_axes(leg: Leg, links: Sequence[str], q: FloatArray) -> FloatArray | None:
    """Choose the constant reference of closed chains for the poses of some samples."""
    found = eliminate(leg, links, q)
    if found.loop is None:
        return None
    P = found.loop @ np.swapaxes(found.loop, 1, 2)
    return _reference(P[found.fit] if found.fit.any() else P, found.loop.shape[2])


def _reference(P: FloatArray, count: int) -> FloatArray:
    """Directions that most samples can move in, (n, count)."""
    _, vectors = np.linalg.eigh(P.mean(axis=0))
    return np.asarray(vectors[:, P.shape[1] - count :])
