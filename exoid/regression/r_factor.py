"""From rows to one small R factor a joint, which is all that least squares needs to know of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .rows import Rows

COLUMNS = 4
"""Columns that are factorised at once: of so few as a joint has, fastest."""


class RFactor(NamedTuple):
    """All that least squares needs to know of the rows of one joint: R of the QR factorisation of [W τ].

    Attributes:
        R: Upper R factor, (P + 1, P + 1).
        rows: How many rows went in.
        samples: How many independent samples they amount to.
    """

    R: FloatArray
    rows: int
    samples: float

    def among(self, columns: NDArray[np.intp], width: int) -> RFactor:
        """Put the columns into the places that they have among so many, the others being zero."""
        R = np.zeros((len(self.R), width))
        R[:, columns] = self.R
        return factorize(R, self.rows, self.samples)

    def residual(self, values: FloatArray) -> float:
        """Root of the sum of squared residuals ‖W β − τ‖ [N·m]."""
        return float(np.linalg.norm(self.R @ np.append(values, -1.0)))


def factorize_rows(rows: Rows) -> list[RFactor]:
    """Reduce the rows of each joint to a R factor."""
    r_factors = []
    for joint in range(rows.tau.shape[1]):
        columns, table = joint_table(rows, joint)
        count = table.shape[1]
        r_factor = factorize(table.T, count, count * rows.independent_fraction)
        r_factors.append(r_factor.among(columns, rows.W.shape[2] + 1))
    return r_factors


def joint_table(rows: Rows, joint: int) -> tuple[NDArray[np.intp], FloatArray]:
    """Columns of [W τ] that act on a joint, the last that of its torque, and usable rows in them, (p, N)."""
    W, use = rows.W[:, joint].T, rows.usable[:, joint]
    columns = np.flatnonzero(rows.acting[joint])
    table = np.empty((len(columns) + 1, int(np.count_nonzero(use))))
    used = slice(None) if use.all() else use
    for row, column in zip(table, columns, strict=False):
        row[:] = W[column, used]
    table[-1] = rows.tau[used, joint]
    return np.append(columns, len(W)), table


def factorize(table: FloatArray, rows: int, samples: float) -> RFactor:
    """Factorise rows of [W τ]."""
    width = table.shape[1]
    if len(table) < width:
        table = np.vstack([table, np.zeros((width - len(table), width))])
    factored, *_ = scipy.linalg.lapack.dgeqrt(min(COLUMNS, width), table)
    return RFactor(np.triu(factored[:width]), rows, samples)


def rms_residual(r_factors: Sequence[RFactor], values: FloatArray) -> float:
    """RMS residual over the rows of several R factors [N·m]."""
    squares = sum(r_factor.residual(values) ** 2 for r_factor in r_factors)
    return float(np.sqrt(squares / max(sum(r_factor.rows for r_factor in r_factors), 1)))


def stack(r_factors: Sequence[RFactor], weights: Sequence[float] | None = None) -> RFactor:
    """Combine R factors, each multiplied by its weight, into the R factor of all their rows."""
    weights = [1.0] * len(r_factors) if weights is None else weights
    table = np.vstack([weight * r_factor.R for weight, r_factor in zip(weights, r_factors, strict=True)])
    return factorize(table, sum(t.rows for t in r_factors), sum(t.samples for t in r_factors))


def refuse_empty_joints(joint_names: Sequence[str], r_factors: Sequence[RFactor]) -> None:
    """Refuse a fit in which the terms' dead bands left no sample of a joint.

    Raises:
        ExoidError: Names the joints.
    """
    empty = [joint for joint, r_factor in zip(joint_names, r_factors, strict=True) if r_factor.rows == 0]
    if empty:
        raise ExoidError(
            f"no sample of {', '.join(empty)} is faster than the dead band of its friction term",
            remedy="move faster, or choose a smaller dead_band",
        )
