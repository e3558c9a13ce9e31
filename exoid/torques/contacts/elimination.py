"""Combinations of rows on which links on the ground do no work (Aghili 2005; Mistry et al. 2010)."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.link_frames import ball_radius
from exoid.leg.torso import MovingBase


class Elimination(NamedTuple):
    """Combinations of rows that links on the ground do no work on, Zᵀ J_cᵀ = 0."""

    # motion −K of the base per rate of each joint while a flat link rests, K (N, b, n); None without base rows, or
    # where no link is flat
    lever: FloatArray | None
    # Z of joint rows: rates of the joints at which the other links rest too, orthonormal, (N, n, r); None for
    # one flat link, which leaves every joint free. Of all rows, (N, b + n, r), where no link is flat
    loop: FloatArray | None
    fit: NDArray[np.bool_]  # whether Z is well defined, (N,)

    def of(self, rows: FloatArray) -> FloatArray:
        """Combine rows."""
        base = 0 if self.lever is None else self.lever.shape[1]
        out = rows[:, base:].copy() if base else rows
        if self.lever is not None:
            lever = np.ascontiguousarray(self.lever.transpose(1, 2, 0))
            for of_joints, of_base in zip(out, rows[:, :base], strict=True):
                if of_base.any():  # friction of joints has no base rows
                    for share, row in zip(lever, of_base, strict=True):
                        np.subtract(of_joints, share * row, out=of_joints)
        if self.loop is None:
            return out
        along = np.ascontiguousarray(self.loop.transpose(1, 2, 0))  # up to six times as fast in this order
        return np.asarray(np.einsum("kjn,jsn->ksn", out, along))


_kept: dict[Hashable, Elimination] = {}  # the newest, up to 32 MiB


def eliminate(
    leg: Leg, links: Sequence[str], q: FloatArray, axes: FloatArray | None = None, base: MovingBase | None = None
) -> Elimination:
    """Find the rows that unknown wrenches on links leave."""
    # A flat link fixes the base: ν_b = −K q̇ with K = J_b⁻¹ J_q. Each further link has J_q − J_b K = C with
    # C q̇ = 0. Joint rates that fulfil it are the null space of C, with the projector P. Their basis Z = P E
    # (Eᵀ P E)^(−1/2) varies smoothly, and is orthonormal, so that each row has the noise of one joint's torque.
    # Points and edges leave the base free to turn: then C is the whole Jacobian, and the base moves among the rates.
    # Constraints and their forces are those of Featherstone (2008, ch. 8), the projector that of Aghili (2005).
    # Mistry et al. (2010) find such rows by QR of J_cᵀ; all choices span the same space (Righetti et al. 2011).
    up = base.up if isinstance(base, BaseKinematics) and any(ball_radius(leg, link) for link in links) else None
    # Torque and columns of a recording ask for the same poses, and so do fits that differ in torque or sensor alone.
    key = (leg, *links, q.shape, q.tobytes(), *(b"" if x is None else x.tobytes() for x in (axes, up)))
    if key in _kept:
        return _kept[key]
    lever, C = _constraints(leg, links, q, up)
    found = Elimination(lever, None, np.ones(len(q), dtype=np.bool_))
    if C is not None:
        squares, U = np.linalg.eigh(C @ np.swapaxes(C, 1, 2))
        # poses by chance have no symmetries; smaller singular values are those of directions that cannot move anyway
        _, chains = _constraints(leg, links, np.random.default_rng(0).standard_normal((5, len(leg.joint_names))))
        assert chains is not None
        rank = int(np.linalg.matrix_rank(chains, rtol=1e-6).max())
        kept = squares[:, -rank:]
        fit = kept[:, 0] > 0.03**2 * kept[:, -1]  # at a straight knee a foot can hardly move up
        # zero is the constraint of a sample that is not fit
        held = np.swapaxes(U[..., -rank:], 1, 2) @ C / np.sqrt(np.maximum(kept, 1e-18))[..., np.newaxis]
        P = np.eye(C.shape[2]) - np.swapaxes(held, 1, 2) @ held
        E = _reference(P[fit] if fit.any() else P, P.shape[1] - rank) if axes is None else axes
        loop, aligned = _orthonormal(P, E)
        found = Elimination(lever, loop, fit & aligned)
    _kept[key] = found
    while sum(part.nbytes for each in _kept.values() for part in each if part is not None) > 2**25:
        del _kept[next(iter(_kept))]
    return found


def load_sharing(loop: FloatArray, axes: FloatArray) -> FloatArray:
    """Find the directions of rows in which links share loads: all but those of closed chains, (N, n, n − r)."""
    P = np.eye(len(axes)) - loop @ np.swapaxes(loop, 1, 2)
    return _orthonormal(P, scipy.linalg.null_space(axes.T))[0]


def _orthonormal(P: FloatArray, E: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Project axes, P E (Eᵀ P E)^(−1/2), and tell where a fifth of each axis is left at least."""
    PE, least = P @ E, 0.2
    parts, turns = np.linalg.eigh(E.T @ PE)
    roots = (turns / np.sqrt(np.maximum(parts, least))[:, None, :]) @ np.swapaxes(turns, 1, 2)
    return PE @ roots, parts.min(axis=1, initial=1.0) > least


def _constraints(
    leg: Leg, links: Sequence[str], q: FloatArray, up: FloatArray | None = None
) -> tuple[FloatArray | None, FloatArray | None]:
    """Form K of the first flat link, and C of the others; None for what there is not."""
    base = leg.base_rows
    jacobians = [leg.contact_jacobian(q, link, up) for link in links]
    flat = [k for k, link in enumerate(links) if leg.contact_kind(link) == "flat"]
    lever: FloatArray | None = None
    if base and flat:
        first = jacobians.pop(flat[0])
        lever = np.asarray(np.linalg.solve(first[..., :base], first[..., base:]), dtype=np.float64)
        jacobians = [each[..., base:] - each[..., :base] @ lever for each in jacobians]
    return lever, np.concatenate(jacobians, axis=1) if jacobians else None


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
