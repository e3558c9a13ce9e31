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
    sizes = [len(group.upper) for group in groups]
    for softened in range(len(groups)):  # a soft constraint that is active is always violated a little
        kinds = [hard] * (len(groups) - softened) + [soft] * softened
        sense = np.repeat(np.array(kinds, dtype=np.intc), sizes)
        y, _, exit_flag, _ = solver.solve(A.T @ A, -(A.T @ b), np.ascontiguousarray(rows), upper, lower, sense)
        if exit_flag > 0:
            return np.asarray(y), softened < 2
    # numbers that no solver takes: the torque is clipped in the end
    return np.asarray(np.linalg.lstsq(A, b)[0], dtype=np.float64), False
