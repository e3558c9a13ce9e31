"""Rows of parameters and nuisance columns, with the R factors that fits and tests of them share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.motion_ranges import MotionRanges
from exoid.regression.row_data import Rows

from .nuisances import Nuisance

ROUNDS, FEWER_ROUNDS = 4, 2
"""Weights of the joints and residuals are computed in turn so often, and so often from weights of a similar fit."""

TINY = 1e-300
"""Smallest variance to divide by."""

FLOOR = 1e-9
"""Residuals below this part of the torque are rounding."""

RANK = 1e-6
"""Columns this close to others, after scaling, are dependent."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """Rows of parameters and nuisance columns of several recordings, decimated to independent noise."""

    parts: Sequence[Rows]  # rows of each recording or set of poses
    at_rest: Sequence[bool]  # whether each is poses
    count: int  # number of parameters P; nuisance columns follow
    fixed: FloatArray  # known values of parameters, (P,); not a number where they are free
    ranges: Sequence[MotionRanges] = ()  # ranges of the motion of each
    # rows of parameters and friction of other forms, of each recording in motion; empty if not formed
    friction: Sequence[Rows] = ()

    @cached_property
    def samples(self) -> int:
        """Rows of all joints."""
        return int(sum(part.usable.sum() for part in self.parts))

    @cached_property
    def joints(self) -> int:
        """Number of joints."""
        return int(self.parts[0].tau.shape[1])

    @cached_property
    def free(self) -> NDArray[np.intp]:
        """Indices of the free parameters."""
        return np.flatnonzero(~np.isfinite(self.fixed))

    def table(self, part: Rows, joint: int) -> FloatArray:
        """Columns of parameters and nuisances, and the torque less that of known parameters, (P + K + 1, N)."""
        W = part.W[:, joint].T
        known = np.where(np.isfinite(self.fixed), self.fixed, 0.0)
        torque = part.tau[:, joint] - known @ W[: self.count]
        return np.asarray(np.vstack([W, torque]) * part.usable[:, joint])

    @cached_property
    def tables(self) -> list[list[FloatArray]]:
        """Tables of each joint, recording by recording."""
        return [[self.table(part, joint) for part in self.parts] for joint in range(self.joints)]

    @cached_property
    def factors(self) -> list[FloatArray]:
        """R factor of the rows of each joint, (M, P + K + 1) with M columns that act."""
        found = []
        for of_joint in self.tables:
            rows = np.hstack(of_joint)
            act = np.flatnonzero(rows.any(axis=1))
            acting = r_factor(rows[act].T)
            R = np.zeros((len(acting), len(rows)))
            R[:, act] = acting
            found.append(R)
        return found

    def torque_shares(self, columns: NDArray[np.intp], sizes: FloatArray) -> FloatArray:
        """RMS torque of each of some columns over that of the joint, at the joint where this is largest."""
        parts = [
            np.linalg.norm(R[:, columns], axis=0) / max(float(np.linalg.norm(R[:, -1])), TINY) for R in self.factors
        ]
        return np.asarray(np.abs(sizes) * np.max(parts, axis=0))

    def torque_share(self, nuisance: Nuisance, delta: FloatArray) -> float:
        """RMS torque of a fault over that of the joint, at the joint where this is largest."""
        columns = self.count + np.array(nuisance.columns)
        sizes = delta if nuisance.group else np.repeat(delta[:1], len(columns))
        return max(
            float(np.linalg.norm(R[:, columns] @ sizes)) / max(float(np.linalg.norm(R[:, -1])), TINY)
            for R in self.factors
        )

    @cached_property
    def counts(self) -> FloatArray:
        """Usable rows of each joint, (n,)."""
        counts = np.sum([part.usable.sum(axis=0) for part in self.parts], axis=0)
        return np.asarray(np.maximum(counts, 1), dtype=np.float64)

    def places(self, nuisances: Sequence[int]) -> NDArray[np.intp]:
        """Find the columns of the free parameters, and some nuisance columns."""
        return np.concatenate([self.free, self.count + np.array(nuisances, dtype=np.intp)]).astype(np.intp)

    def weights(self, columns: NDArray[np.intp], start: FloatArray | None = None) -> FloatArray:
        """Weigh the joints by the residuals of a fit of some columns."""
        torque = np.array([np.linalg.norm(R[:, -1]) for R in self.factors]) / np.sqrt(self.counts)
        floor = FLOOR * max(float(torque.max(initial=0.0)), 1e-12)
        weights = 1.0 / np.maximum(torque, floor) if start is None else start
        fitted = [r_factor(R[:, np.append(columns, -1)]) for R in self.factors]
        for _ in range(ROUNDS if start is None else FEWER_ROUNDS):
            R = np.vstack([w * R for w, R in zip(weights, fitted, strict=True)])
            solution = solution_of(R[:, :-1], R[:, -1])
            rms = [np.linalg.norm(R_j[:, -1] - R_j[:, :-1] @ solution) for R_j in fitted] / np.sqrt(self.counts)
            weights = 1.0 / np.maximum(rms, floor)
        return np.asarray(weights)


def r_factor(rows: FloatArray) -> FloatArray:
    """Reduce rows to their R factor."""
    return np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)


def solution_of(A: FloatArray, b: FloatArray) -> FloatArray:
    """Solve a least-squares problem with columns scaled to unit length, by an orthogonal decomposition with pivots."""
    scale = np.linalg.norm(A, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    x, *_ = scipy.linalg.lstsq(A / scale, b, cond=RANK, lapack_driver="gelsy", check_finite=False)
    return np.asarray(x / scale)


def pseudo_inverse(A: FloatArray) -> FloatArray:
    """Compute the pseudo-inverse with columns scaled to unit length."""
    scale = np.linalg.norm(A, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    return np.asarray(np.linalg.pinv(A / scale, rcond=RANK) / scale[:, None])
