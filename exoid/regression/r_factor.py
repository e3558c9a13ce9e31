"""From rows to one small triangle a joint, which is all that least squares needs to know of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.torques import TorqueModel

from .rows import Rows

COLUMNS = 4
"""Columns that are factorised at once: of so few as a joint has, fastest."""


class Triangle(NamedTuple):
    """All that least squares needs to know of the rows of one joint: R of the QR factorisation of [W τ].

    Attributes:
        R: Upper triangle, (P + 1, P + 1).
        rows: How many rows went in.
        samples: How many independent samples they amount to.
    """

    R: FloatArray
    rows: int
    samples: float

    def among(self, columns: NDArray[np.intp], width: int) -> Triangle:
        """Put the columns into the places that they have among so many, the others being zero."""
        R = np.zeros((len(self.R), width))
        R[:, columns] = self.R
        return make_triangle(R, self.rows, self.samples)

    def residual(self, values: FloatArray) -> float:
        """Root of the sum of squared residuals ‖W β − τ‖ [N·m]."""
        return float(np.linalg.norm(self.R @ np.append(values, -1.0)))


def make_triangles(rows: Rows) -> list[Triangle]:
    """Reduce the rows of each joint to a triangle."""
    triangles = []
    for joint in range(rows.tau.shape[1]):
        columns, table = joint_table(rows, joint)
        count = table.shape[1]
        triangle = make_triangle(table.T, count, count * rows.independence)
        triangles.append(triangle.among(columns, rows.W.shape[2] + 1))
    return triangles


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


def make_triangle(table: FloatArray, rows: int, samples: float) -> Triangle:
    """Factorise rows of [W τ]."""
    width = table.shape[1]
    if len(table) < width:
        table = np.vstack([table, np.zeros((width - len(table), width))])
    factored, *_ = scipy.linalg.lapack.dgeqrt(min(COLUMNS, width), table)
    return Triangle(np.triu(factored[:width]), rows, samples)


def rms_residual(triangles: Sequence[Triangle], values: FloatArray) -> float:
    """RMS residual over the rows of several triangles [N·m]."""
    squares = sum(triangle.residual(values) ** 2 for triangle in triangles)
    return float(np.sqrt(squares / max(sum(triangle.rows for triangle in triangles), 1)))


def join(triangles: Sequence[Triangle], weights: Sequence[float] | None = None) -> Triangle:
    """Combine triangles, each multiplied by its weight, into the triangle of all their rows."""
    weights = [1.0] * len(triangles) if weights is None else weights
    table = np.vstack([weight * triangle.R for weight, triangle in zip(weights, triangles, strict=True)])
    return make_triangle(table, sum(t.rows for t in triangles), sum(t.samples for t in triangles))


def refuse_empty_joints(model: TorqueModel, triangles: Sequence[Triangle]) -> None:
    """Refuse a fit in which the terms' dead bands left no sample of a joint.

    Raises:
        ExoidError: Names the joints.
    """
    empty = [joint for joint, triangle in zip(model.leg.joint_names, triangles, strict=True) if triangle.rows == 0]
    if empty:
        raise ExoidError(
            f"no sample of {', '.join(empty)} is faster than the dead band of its friction term",
            remedy="move faster, or choose a smaller dead_band",
        )
