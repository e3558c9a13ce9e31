"""Smooth angle trajectories, quintic B-splines on even knots, and their normal equations beside the parameters."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray

DEGREE = 5  # of the splines: accelerations are then cubic pieces with a continuous slope and curvature
WIDTH = DEGREE + 1  # basis functions that are not zero at a sample


class Trajectory(NamedTuple):
    """Splines q(t) = Σ_k B_k(t) c_k seen at N samples."""

    basis: FloatArray  # the basis functions that are not zero at each sample, and their derivatives, (3, N, 6)
    interval: NDArray[np.intp]  # between which knots each sample lies; also the first of those basis functions, (N,)
    members: NDArray[np.intp]  # samples in each interval; N where there are fewer than M, (K − 5, M)
    size: int  # number of coefficients K of each joint

    @classmethod
    def on(cls, time: FloatArray, spacing: float) -> Trajectory:
        """Lay knots over stamps."""
        span = float(time[-1] - time[0])
        intervals = max(1, int(np.ceil(span / spacing - 1e-9)))
        place = (time - time[0]) * (intervals / span)
        interval = np.minimum(place.astype(np.intp), intervals - 1)
        basis = np.array([pieces(place - interval) * (intervals / span) ** k for k, pieces in enumerate(_pieces())])
        first = np.searchsorted(interval, np.arange(intervals + 1))
        members = np.full((intervals, int(np.diff(first).max())), len(time), dtype=np.intp)
        members[interval, np.arange(len(time)) - first[interval]] = np.arange(len(time))
        return cls(basis, interval, members, intervals + DEGREE)

    def through(self, q: FloatArray) -> FloatArray:
        """Coefficients, (K, n), of the splines nearest to angles, (N, n)."""
        near = self.basis[0]
        sums = self.grouped(near).transpose(0, 2, 1) @ self.grouped(np.concatenate([near, q], axis=1))
        right = self.overlap(sums[..., WIDTH:])
        return np.asarray(scipy.linalg.solveh_banded(lower_band(sums, 1), right, lower=True, check_finite=False))

    def at_samples(self, coefficients: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Angles, velocities and accelerations, (N, n) each, from coefficients, (K, n)."""
        q, v, a = self.basis[:, :, None, :] @ self.near(coefficients)
        return q[:, 0], v[:, 0], a[:, 0]

    def grouped(self, x: FloatArray) -> FloatArray:
        """Sort samples by interval, (N, ...) to (K − 5, M, ...), filled up with zeros."""
        padded = np.concatenate([x, np.zeros((1, *x.shape[1:]))])
        return np.asarray(padded[self.members])

    def overlap(self, x: FloatArray) -> FloatArray:
        """Sum what the intervals say on the 6 coefficients near each, (K − 5, 6, ...) to (K, ...)."""
        out = np.zeros((self.size, *x.shape[2:]))
        for k in range(WIDTH):
            out[k : k + len(x)] += x[:, k]
        return out

    def near(self, coefficients: FloatArray) -> FloatArray:
        """Coefficients of the functions that are not zero at each sample, (K, ...) to (N, 6, ...)."""
        return np.asarray(coefficients[self.interval[:, None] + np.arange(WIDTH)])


def lower_band(local: FloatArray, n: int) -> FloatArray:
    """Lower band of the normal matrix of n joints, (6 n, K n), from the blocks of the intervals."""
    intervals = len(local)
    count = intervals + WIDTH - 1
    band = np.zeros((WIDTH * n, count, n))
    for column in range(WIDTH):
        for row in range(column, WIDTH):
            block = local[:, row * n : (row + 1) * n, column * n : (column + 1) * n]
            for i in range(n):
                for j in range(n if row > column else i + 1):
                    band[(row - column) * n + i - j, column : column + intervals, j] += block[:, i, j]
    band[0] *= 1.0 + 1e-10  # a coefficient that hardly any sample sees does no harm
    return band.reshape(WIDTH * n, count * n)


@cache
def _pieces() -> tuple[scipy.interpolate.PPoly, ...]:
    """The six pieces of the B-spline on unit knots as functions of the place in an interval, and their derivatives."""
    # In an interval the function that started there is in its first piece, the one that started five knots
    # before in its last.
    spline = scipy.interpolate.BSpline.basis_element(np.arange(WIDTH + 1.0), extrapolate=False)
    whole = scipy.interpolate.PPoly.from_spline(spline.tck)
    inner = (whole.x[:-1] >= 0.0) & (whole.x[1:] <= WIDTH) & (np.diff(whole.x) > 0.0)
    pieces = whole.c[:, inner][:, ::-1]
    value = scipy.interpolate.PPoly(pieces[:, None, :], np.array([0.0, 1.0]))
    return value, value.derivative(), value.derivative(2)


class BorderedRows(NamedTuple):
    """Weighted residuals at each sample, measured less predicted, and the derivatives of what is predicted."""

    torque: FloatArray  # residuals of the torques, (N, n)
    angle: FloatArray  # residuals of the angles, (N, n)
    J: FloatArray  # derivatives of the torques with respect to the 6 n coefficients near the sample, (N, n, 6 n)
    W: FloatArray  # derivatives of the torques with respect to β, (N, n, P)
    angle_weight: FloatArray  # derivatives of the angles are the basis functions times this, (n,)


class ReducedSystem(NamedTuple):
    """What is left for β when the trajectory has been put in that is best for it."""

    # With H_cc, H_cβ, H_ββ the blocks of the normal matrix, c the trajectory's coefficients:

    factor: FloatArray  # banded Cholesky factor of H_cc, lower form
    coupling: FloatArray  # H_cc⁻¹ H_cβ, (K n, P)
    free: FloatArray  # step of c while β stays, H_cc⁻¹ g_c, (K n,)
    matrix: FloatArray  # H_ββ − H_βc H_cc⁻¹ H_cβ, (P, P)
    gradient: FloatArray  # g_β − H_βc H_cc⁻¹ g_c, (P,)

    def solve(self, right: FloatArray) -> FloatArray:
        """H_cc⁻¹ times columns, (K n, m)."""
        return np.asarray(scipy.linalg.cho_solve_banded((self.factor, True), right, check_finite=False))


def eliminate(trajectory: Trajectory, rows: BorderedRows) -> ReducedSystem:
    """Form the normal equations of one recording and eliminate its trajectory."""
    # Products of rows are summed over the samples between two knots, which all see the same 6 n coefficients.
    n, P = rows.torque.shape[1], rows.W.shape[2]
    right = np.concatenate([rows.J, rows.W, rows.torque[..., None]], axis=-1)
    grouped = trajectory.grouped(right)
    grouped = grouped.reshape(len(grouped), -1, right.shape[-1])
    local = grouped[..., : WIDTH * n].transpose(0, 2, 1) @ grouped
    near, angle = trajectory.basis[0], rows.angle * rows.angle_weight
    grouped = trajectory.grouped(np.concatenate([near, angle], axis=1))
    angles = grouped[..., :WIDTH].transpose(0, 2, 1) @ grouped
    for joint in range(n):
        mine = slice(joint, WIDTH * n, n)
        local[:, mine, mine] += rows.angle_weight[joint] ** 2 * angles[..., :WIDTH]
        local[:, mine, -1] += angles[..., WIDTH + joint]
    flat = right.reshape(-1, right.shape[-1])[:, WIDTH * n :]
    corner = flat[:, :P].T @ flat
    border = trajectory.overlap(local[..., WIDTH * n :].reshape(len(local), WIDTH, n, P + 1)).reshape(-1, P + 1)
    factor = scipy.linalg.cholesky_banded(lower_band(local, n), lower=True, overwrite_ab=True, check_finite=False)
    inverse = scipy.linalg.cho_solve_banded((factor, True), border, check_finite=False)
    left = corner - border[:, :P].T @ inverse
    return ReducedSystem(factor, inverse[:, :P], inverse[:, P], 0.5 * (left[:, :P] + left[:, :P].T), left[:, P])
