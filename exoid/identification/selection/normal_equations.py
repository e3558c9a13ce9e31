"""Normal equations of the rows, from which every candidate of every joint follows by small linear algebra."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.least_squares import TINY

from .design import Design

RIDGE = 1e-10  # added to the diagonal, relatively: columns of one joint at neighbouring settings are nearly dependent

Active = Sequence[NDArray[np.intp]]
"""Indices of the friction columns of each joint that are fitted."""


class NormalEquations(NamedTuple):
    """Weighted sums of products of columns and torques, over some rows."""

    base: FloatArray  # base columns with each other, (p, p)
    mixed: tuple[FloatArray, ...]  # base columns with friction columns of each joint, n of (p, K)
    friction: tuple[FloatArray, ...]  # friction columns of each joint with each other, n of (K, K)
    base_torque: FloatArray  # base columns with the torque, (p,)
    friction_torque: tuple[FloatArray, ...]  # friction columns of each joint with its torque, n of (K,)

    @classmethod
    def of(cls, design: Design, weights: FloatArray) -> NormalEquations:
        """Sum over rows."""
        weighted = [base * w[:, None] for base, w in zip(design.base, weights, strict=True)]
        loaded = [F * w[:, None] for F, w in zip(design.friction, weights, strict=True)]
        base = np.sum([a.T @ b for a, b in zip(weighted, design.base, strict=True)], axis=0)
        torque = np.sum([a.T @ t for a, t in zip(weighted, design.tau, strict=True)], axis=0)
        for k, value in design.known.items():
            sure = 1e8 * base[k, k]  # information about a known parameter, far above that of all rows
            base[k, k] += sure
            torque[k] += sure * value
        both = weighted, loaded
        slid, pulled = (tuple(a.T @ F for a, F in zip(each, design.friction, strict=True)) for each in both)
        return cls(base, slid, pulled, torque, tuple(a.T @ t for a, t in zip(loaded, design.tau, strict=True)))

    def solve(self, active: Active) -> tuple[FloatArray, list[FloatArray]]:
        """Solve for base parameters and the friction coefficients of all joints."""
        L, scale, right = self._factored(active)
        solution = scale * scipy.linalg.cho_solve((L, True), scale * right)
        count = len(self.base_torque)
        ends = np.cumsum([count, *(len(k) for k in active)])
        return solution[:count], [solution[a:b] for a, b in itertools.pairwise(ends)]

    def project(self, joint: int, active: Active) -> JointEquations:
        """Eliminate the base parameters and the friction of all other joints."""
        L, scale, right = self._factored([k if j != joint else k[:0] for j, k in enumerate(active)])
        beside = np.zeros((len(L), len(self.friction[joint])))
        beside[: len(self.base)] = self.mixed[joint]
        V = scipy.linalg.solve_triangular(L, scale[:, None] * beside, lower=True)
        u = scipy.linalg.solve_triangular(L, scale * right, lower=True)
        square = self.friction[joint] - V.T @ V + np.diag(RIDGE * np.diag(self.friction[joint]) + TINY)
        ahead, along = (scipy.linalg.solve_triangular(L, x, lower=True, trans="T") for x in (u, V))
        return JointEquations(square, self.friction_torque[joint] - V.T @ u, scale * ahead, scale[:, None] * along)

    def _factored(self, active: Active) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Cholesky factor of the matrix of base and active friction columns, its scale, and the right-hand side."""
        count = len(self.base)
        ends = np.cumsum([count, *(len(k) for k in active)])
        table, right = np.zeros((ends[-1], ends[-1])), np.zeros(ends[-1])
        table[:count, :count], right[:count] = self.base, self.base_torque
        for joint, columns in enumerate(active):
            rows = slice(ends[joint], ends[joint + 1])
            table[:count, rows] = self.mixed[joint][:, columns]
            table[rows, :count] = table[:count, rows].T
            table[rows, rows] = self.friction[joint][np.ix_(columns, columns)]
            right[rows] = self.friction_torque[joint][columns]
        scale = 1.0 / np.sqrt(np.maximum(np.diag(table), TINY))
        L = np.linalg.cholesky(table * scale * scale[:, None] + RIDGE * np.eye(len(table)))
        return np.asarray(L), scale, right


class JointEquations(NamedTuple):
    """Normal equations M c = r of the friction coefficients c of one joint; the other parameters are x − X c."""

    M: FloatArray  # (K, K)
    r: FloatArray  # (K,)
    x: FloatArray  # base parameters and friction coefficients of the other joints without friction of this one, (Q,)
    X: FloatArray  # by how much the coefficients lower them, (Q, K)

    def residuals(self, design: Design, joint: int, active: Active) -> tuple[FloatArray, FloatArray]:
        """Form residuals r − c G, as a function of the coefficients c."""
        count = design.base.shape[2]
        left, columns = design.tau - design.base @ self.x[:count], -(design.base @ self.X[:count])
        columns[joint] += design.friction[joint]
        first = count
        for other, used in enumerate(active):
            if other == joint:
                continue
            last = first + len(used)
            F = design.friction[other][:, used]
            left[other] -= F @ self.x[first:last]
            columns[other] -= F @ self.X[first:last]
            first = last
        return left, np.ascontiguousarray(np.moveaxis(columns, 2, 0))

    def solve(self, sets: NDArray[np.intp]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Solve for several sets of columns at once: coefficients, their variances, and what each set explains."""
        if sets.shape[1] == 0:
            return np.zeros(sets.shape), np.zeros(sets.shape), np.zeros(len(sets))
        inverse = np.linalg.inv(self.M[sets[:, :, None], sets[:, None, :]])
        right = self.r[sets]
        coefficients = np.einsum("sij,sj->si", inverse, right)
        return coefficients, np.einsum("sii->si", inverse), np.einsum("si,si->s", coefficients, right)


def residuals(design: Design, active: Active, base: FloatArray, friction: Sequence[FloatArray]) -> FloatArray:
    """Torque that a solution leaves unexplained."""
    left = design.tau - design.base @ base
    for joint, (columns, values) in enumerate(zip(active, friction, strict=True)):
        left[joint] -= design.friction[joint][:, columns] @ values
    return np.asarray(left)
