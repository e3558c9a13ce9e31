"""Small quadratic program by DAQP (extra ``stance``), a dual active-set solver in C (Arnström et al. 2022)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.tools.extras import install_extra


def require_daqp() -> Any:  # noqa: ANN401 - a module
    """Import DAQP, an extra of exoid."""
    try:
        import daqp  # noqa: PLC0415 - an extra
    except ImportError:
        raise NotSupportedError("the QP solver DAQP is not installed", remedy=install_extra("stance")) from None
    return daqp


YIELDS = 1e-3
"""Slack of a row that yields at the cost 1, over its size: DAQP's own, the root of ``rho_soft``."""


class Rows(NamedTuple):
    """Inequalities, lower ≤ rows y ≤ upper."""

    rows: FloatArray  # (k, m)
    lower: FloatArray  # (k,)
    upper: FloatArray  # (k,)


def minimise(A: FloatArray, b: FloatArray, groups: Sequence[Rows]) -> tuple[FloatArray, bool]:
    """Minimise |A y − b|² under groups of inequalities; also whether at most those of the last group are violated.

    If no y fulfils all, the last group is violated as little as need be, then the one before it, too; never the first.
    """
    solver, hard, soft = require_daqp(), 0, 8  # DAQP's kinds of constraints
    rows, lower, upper = (np.concatenate(parts) for parts in zip(*groups, strict=True))
    sizes, H = [len(group.upper) for group in groups], A.T @ A
    for softened in range(len(groups)):  # a soft constraint that is active is always violated a little
        kinds = [hard] * (len(groups) - softened) + [soft] * softened
        sense = np.repeat(np.array(kinds, dtype=np.intc), sizes)
        _, _, exit_flag, info = solver.solve(H, -(A.T @ b), np.ascontiguousarray(rows), upper, lower, sense)
        if exit_flag > 0:
            held = info["lam"] != 0.0  # multipliers, positive at the upper bound
            bounds = np.where(info["lam"] > 0.0, upper, lower)[held]
            return _polish(A, b, rows[held], bounds, YIELDS * (sense == soft)[held]), softened < 2
    # numbers that no solver takes: the torque is clipped in the end
    return np.asarray(np.linalg.lstsq(A, b)[0], dtype=np.float64), False


def _polish(A: FloatArray, b: FloatArray, E: FloatArray, bounds: FloatArray, yields: FloatArray) -> FloatArray:
    """Solve once more, for equality of the rows with multipliers: DAQP's factors lose digits from step to step."""
    size = np.sqrt(np.einsum("im,mi->i", E, np.linalg.solve(A.T @ A, E.T)))
    # a row that yields has a slack t of its own, row y + yields t = bound, at the cost |t|²
    x, N = solutions(np.hstack([E, np.diag(yields * size)[:, yields > 0.0]]), bounds)
    m = A.shape[1]
    free = np.linalg.lstsq(np.vstack([A @ N[:m], N[m:]]), np.append(b - A @ x[:m], -x[m:]))[0]
    return np.asarray(x[:m] + N[:m] @ free)


def solutions(E: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """All x with E x = b: the smallest one, and a basis of what may be added; rows may say a thing twice."""
    U, s, Vt = np.linalg.svd(E)
    rank = int(np.count_nonzero(s > 1e-9 * s.max(initial=0.0)))
    return Vt[:rank].T @ ((U[:, :rank].T @ b) / s[:rank]), Vt[rank:].T
