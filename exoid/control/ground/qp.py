"""Small quadratic program by DAQP (extra ``stance``), a dual active-set solver in C (Arnström et al. 2022)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.tools.extras import install_extra

HARD, SOFT = 0, 8
"""DAQP's kinds of constraints: one that holds, and one that is violated as little as need be."""


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


class Minimum(NamedTuple):
    """Solution of a quadratic program."""

    y: FloatArray  # (m,)
    feasible: bool  # whether all inequalities hold; otherwise the soft ones are violated as little as need be


def minimise(daqp: Any, A: FloatArray, b: FloatArray, hard: Rows, soft: Rows) -> Minimum:  # noqa: ANN401
    """Minimise |A y − b|² under inequalities, the soft ones of which may be violated if no y fulfils all."""
    rows, lower, upper = (np.concatenate(pair) for pair in zip(hard, soft, strict=True))
    sizes = [len(hard.upper), len(soft.upper)]
    for kind in (HARD, SOFT):  # a soft constraint that is active is always violated a little
        sense = np.repeat(np.array([HARD, kind], dtype=np.intc), sizes)
        y, _, exit_flag, _ = daqp.solve(A.T @ A, -(A.T @ b), np.ascontiguousarray(rows), upper, lower, sense)
        if exit_flag > 0:
            return Minimum(np.asarray(y), kind == HARD)
    return Minimum(
        np.asarray(np.linalg.lstsq(A, b)[0], dtype=np.float64), False
    )  # numbers that no solver takes: the torque is clipped in the end
