"""Rows of parameters and nuisance columns, with the R factors that fits and tests of them share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.evidence import MotionRanges
from exoid.regression.least_squares import TINY, scaled_lstsq
from exoid.regression.row_data import Rows


class Evidence(NamedTuple):
    """Rows of parameters and nuisance columns of several recordings, decimated to independent noise."""

    parts: Sequence[Rows]  # rows of each recording or set of poses
    at_rest: Sequence[bool]  # whether each is poses
    fixed: FloatArray  # known values of parameters, (P,); not a number where they are free
    free: NDArray[np.intp]  # indices of the free parameters
    # of each joint and recording: all columns, and torque less that of known parameters, (P + K + 1, N)
    tables: list[list[FloatArray]]
    factors: list[FloatArray]  # R factors of rows [W Z τ] of each joint, known torque included, (M, P + K + 1) each
    counts: FloatArray  # usable rows of each joint, at least 1, (n,)
    ranges: MotionRanges | None = None  # ranges of all motions
    sources: Sequence[str] = ()  # file of each; "" for one in memory
    hints: FloatArray = np.zeros((0, 3))  # see `exoid.identification.findings.columns.residual_hints`

    @property
    def share_of_two(self) -> float:
        """Part of the weighted squared residuals that two joints have: weights make those of all joints alike."""
        return min(1.0, 2.0 / max(1, int(np.count_nonzero(self.counts > 1.0))))

    @classmethod
    def of(cls, parts: Sequence[Rows], at_rest: Sequence[bool], fixed: FloatArray, *, beside: int) -> Evidence:
        """Form the tables and R factors of rows, whose last columns may stand beside them."""
        known = np.where(np.isfinite(fixed), fixed, 0.0)

        def table(part: Rows, joint: int) -> FloatArray:
            W = part.W[:, joint, : part.W.shape[2] - beside].T
            return np.asarray(np.vstack([W, part.tau[:, joint] - known @ W[: len(fixed)]]) * part.usable[:, joint])

        tables = [[table(part, joint) for part in parts] for joint in range(parts[0].tau.shape[1])]
        counts = np.maximum(np.sum([part.usable.sum(axis=0) for part in parts], axis=0), 1).astype(np.float64)
        return cls(parts, at_rest, fixed, np.flatnonzero(~np.isfinite(fixed)), tables, [], counts).of_tables(tables)

    def of_tables(self, tables: list[list[FloatArray]]) -> Evidence:
        """Replace the tables, and with them the R factors."""
        factors = [r_factor(np.hstack(of_joint).T) for of_joint in tables]
        for R in factors:  # checks compare sizes with the whole torque, however much of it is known
            R[:, -1] += R[:, : len(self.fixed)] @ np.nan_to_num(self.fixed)
        return self._replace(tables=tables, factors=factors)

    def reduced(self, R: FloatArray, columns: NDArray[np.intp]) -> FloatArray:
        """Some columns of an R factor, and its torque less that of the known parameters."""
        return np.column_stack([R[:, columns], R[:, -1] - R[:, : len(self.fixed)] @ np.nan_to_num(self.fixed)])

    def weights(self, columns: NDArray[np.intp], start: FloatArray | None = None) -> FloatArray:
        """Weigh the joints by the residuals of a fit of some columns."""
        torque = np.array([np.linalg.norm(R[:, -1]) for R in self.factors]) / np.sqrt(self.counts)
        floor = 1e-9 * max(float(torque.max(initial=0.0)), 1e-12)  # smaller residuals are rounding
        weights = 1.0 / np.maximum(torque, floor) if start is None else start
        fitted = [r_factor(self.reduced(R, columns)) for R in self.factors]
        for _ in range(4 if start is None else 2):  # weights and residuals in turn; fewer from those of a similar fit
            R = np.vstack([w * R for w, R in zip(weights, fitted, strict=True)])
            solution = scaled_lstsq(R[:, :-1], R[:, -1])
            rms = [np.linalg.norm(R_j[:, -1] - R_j[:, :-1] @ solution) for R_j in fitted] / np.sqrt(self.counts)
            weights = 1.0 / np.maximum(rms, floor)
        return np.asarray(weights)


def torque_shares(
    factors: Iterable[FloatArray], columns: Sequence[int] | NDArray[np.intp], sizes: FloatArray
) -> FloatArray:
    """RMS torques of m sums of columns (C, m) over that of the joint, at the joint where this is largest, (m,)."""
    of_joints = [np.linalg.norm(R[:, columns] @ sizes, axis=0) / max(np.linalg.norm(R[:, -1]), TINY) for R in factors]
    return np.asarray(np.max(of_joints, axis=0))


def r_factor(rows: FloatArray) -> FloatArray:
    """Reduce rows to their R factor, which has no more rows than columns that act."""
    act = np.flatnonzero(rows.any(axis=0))
    acting = np.linalg.qr(rows[:, act], mode="r")
    factor = np.zeros((len(acting), rows.shape[1]))
    factor[:, act] = acting
    return factor
