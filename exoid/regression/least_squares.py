"""Least squares on R factors: all rows of a joint in one triangle, and which parameters they determine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, ExoidError, NotIdentifiableError

from .parameters import NO_PRIOR_KNOWLEDGE, PriorKnowledge
from .row_data import Rows

RANK = 1e-7
"""Singular values of unit columns below this part of the largest count as zero (docs/decisions/rank-rule.md)."""

RANK_OF_SQUARES = 1e-12
"""The same for normal equations and covariances, whose singular values are squares: rounding hides smaller ones."""

INVOLVED = 0.05
"""A parameter with less than this part in a direction that the rows do not see is not blamed for it."""

ROUNDING = 1e-9
"""Residuals below this part of the torque are rounding, and make no row surer."""

TINY = 1e-150
"""Smallest number to divide by."""


class RFactor(NamedTuple):
    """R factor of the QR factorisation of [W τ] of one joint: all that least squares needs of its rows."""

    R: FloatArray  # upper R factor, (P + 1, P + 1)
    rows: int  # number of rows that it stands for
    samples: float  # number of independent samples among them
    taken: FloatArray | None = None  # R factor of what was taken out at reversals, (P + 1, P + 1); None for nothing
    all_rows: int = 0  # number of rows with what was taken out

    def among(self, columns: NDArray[np.intp], width: int) -> RFactor:
        """Put the columns into the places that they have among so many, the others being zero."""
        R, taken = np.zeros((len(self.R), width)), None
        R[:, columns] = self.R
        if self.taken is not None:
            taken = np.zeros((len(self.taken), width))
            taken[:, columns] = self.taken
        return factorize(R, self.rows, self.samples)._replace(taken=taken, all_rows=self.all_rows)

    def residual(self, values: FloatArray) -> float:
        """Root of the sum of squared residuals ‖W β − τ‖ [N·m]."""
        return float(np.linalg.norm(self.R @ np.append(values, -1.0)))


def factorize_rows(rows: Rows) -> list[RFactor]:
    """Reduce the rows of each joint to a R factor."""
    r_factors = []
    for joint in range(rows.tau.shape[1]):
        columns, table = joint_table(rows, joint)
        count = table.shape[1]
        taken, left = rows.reversals[joint] if rows.reversals else (None, 1.0)
        r_factor = factorize(table.T, round(left * count), left * count * rows.independent_fraction)
        r_factor = r_factor.among(columns, rows.W.shape[2] + 1)
        taken = None if taken is None else factorize(taken, 0, 0.0).R
        r_factors.append(r_factor._replace(taken=taken, all_rows=count))
    return r_factors


def joint_table(rows: Rows, joint: int) -> tuple[NDArray[np.intp], FloatArray]:
    """Columns of [W τ] that act on a joint, the last that of its torque, and usable rows in them, (p, N).

    Args:
        rows: Rows of all joints.
        joint: Index of the joint.

    Returns:
        Indices of the columns, and the table, (p,) and (p, N).
    """
    W, use = rows.W[:, joint].T, rows.usable[:, joint]
    columns = np.flatnonzero(rows.acting[joint])
    table = np.empty((len(columns) + 1, int(np.count_nonzero(use))))
    used = slice(None) if use.all() else use
    for row, column in zip(table, columns, strict=False):
        row[:] = W[column, used]
    table[-1] = rows.tau[used, joint]
    return np.append(columns, len(W)), table


def factorize(table: FloatArray, rows: int, samples: float) -> RFactor:
    """Reduce rows of [W τ] to their R factor."""
    width = table.shape[1]
    if len(table) < width:
        table = np.vstack([table, np.zeros((width - len(table), width))])
    factored, *_ = scipy.linalg.lapack.dgeqrt(min(4, width), table)  # blocks of 4: fastest for so few columns
    return RFactor(np.triu(factored[:width]), rows, samples)


def rms_residual(r_factors: Sequence[RFactor], values: FloatArray) -> float:
    """RMS residual over the rows of several R factors, reversals included [N·m]."""
    error = np.append(values, -1.0)
    parts = [part for each in r_factors for part in (each.R, each.taken) if part is not None]
    squares = sum(float(np.linalg.norm(part @ error)) ** 2 for part in parts)
    return float(np.sqrt(squares / max(sum(max(t.rows, t.all_rows) for t in r_factors), 1)))


def stack(r_factors: Sequence[RFactor], weights: Sequence[float] | None = None) -> RFactor:
    """Combine R factors, each multiplied by its weight, into the R factor of all their rows.

    Args:
        r_factors: R factors of the same parameters.
        weights: Weight of the rows of each; None for 1.

    Returns:
        R factor of all rows.
    """
    weights = [1.0] * len(r_factors) if weights is None else weights
    weighted = list(zip(weights, r_factors, strict=True))
    stacked = factorize(
        np.vstack([weight * each.R for weight, each in weighted]),
        sum(each.rows for each in r_factors),
        sum(each.samples for each in r_factors),
    )
    taken = [weight * each.taken for weight, each in weighted if each.taken is not None]
    all_rows = sum(max(each.rows, each.all_rows) for each in r_factors)
    return stacked._replace(taken=factorize(np.vstack(taken), 0, 0.0).R if taken else None, all_rows=all_rows)


def column_scale(A: FloatArray) -> FloatArray:
    """Length of each column; 1 for one that is zero."""
    scale = np.linalg.norm(A, axis=0)
    return np.where(scale > 0.0, scale, 1.0)


def scaled_lstsq(A: FloatArray, b: FloatArray) -> FloatArray:
    """Minimise ‖A x − b‖ with columns of unit length; x is zero in directions that count as unseen (RANK)."""
    scale = column_scale(A)
    x, *_ = np.linalg.lstsq(A / scale, b, rcond=RANK)
    return np.asarray((x.T / scale).T)


def scaled_pinv(A: FloatArray) -> FloatArray:
    """Solve as :func:`scaled_lstsq` for any right-hand side."""
    scale = column_scale(A)
    return np.asarray(np.linalg.pinv(A / scale, rcond=RANK) * (A.any(axis=0) / scale)[:, None])  # no row of rounding


def scaled_inverse(M: FloatArray) -> FloatArray:
    """Pseudo-inverse of normal equations or a covariance, or of many, scaled to a diagonal of 1 (RANK_OF_SQUARES)."""
    scale = np.sqrt(np.clip(np.diagonal(M, axis1=-2, axis2=-1), 0.0, None))
    both = np.einsum("...i,...j->...ij", *[np.where(scale > 0.0, scale, 1.0)] * 2)
    return np.asarray(np.linalg.pinv(M / both, rcond=RANK_OF_SQUARES, hermitian=True) / both)


class Solution(NamedTuple):
    """Least-squares estimate with its evidence."""

    values: FloatArray  # β, (P,)
    covariance: FloatArray  # for independent noise of one size in all rows, as weighted, (P, P)
    condition_number: float  # condition number of the regressor with columns scaled to unit length
    dof: float  # independent samples less parameters
    inverse: FloatArray  # (WᵀW)⁻¹ of the rows as weighted, with those of priors; zero for known parameters, (P, P)
    prior_noise: FloatArray  # share of the priors' own uncertainty in Wᵀ Γ W, (P, P)
    bounded: tuple[int, ...] = ()  # indices of parameters that would have become negative
    sigma: FloatArray = np.ones(0)  # singular values of the regressor of unit columns, the largest first, (p,)
    Vt: FloatArray = np.ones((0, 0))  # its right singular vectors, (p, p)
    free: NDArray[np.intp] = np.zeros(0, dtype=np.intp)  # indices of the p parameters that are not known


def solve(
    r_factor: RFactor,
    names: Sequence[str],
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE,
    nonnegative: NDArray[np.bool_] | None = None,
) -> Solution:
    """Minimise ‖W β − τ‖ (doc. 1, eq. (17), without its normal matrix)."""
    # With columns scaled to unit length and R = U Σ Vᵀ, β = V Σ⁻¹ Uᵀ (Qᵀτ) and cov β = s² V Σ⁻² Vᵀ. Of m rows only m'
    # carry independent noise, so that each residual counts m'/m: s² = ‖residual‖² / (m' − P).
    #
    # Known parameters leave the problem with their torque. A prior p ± σ becomes a row (s/σ) β = (s/σ) p: s is what a
    # row of the recordings is worth, so that redundant rows do not outvote it.
    all_values = prior_knowledge.fixed_values(names)
    free = np.isnan(all_values)
    if not free.any():
        raise BadArgumentError("every parameter is known: nothing is left to identify", remedy="leave some unknown")
    reduced = r_factor
    if not free.all():
        torque = r_factor.R @ np.append(np.where(free, 0.0, -all_values), 1.0)
        reduced = factorize(np.column_stack([r_factor.R[:, np.append(free, False)], torque]), 0, r_factor.samples)
    count = len(reduced.R) - 1
    dof = r_factor.samples - count
    if dof <= 0.0:
        raise NotIdentifiableError(
            f"too few samples: {r_factor.samples:.0f} independent ones for {count} parameters",
            remedy="record longer, or raise the cut-off",
        )
    priors = prior_knowledge.pseudo_rows(names)
    priors = priors[:, np.append(free, True)]
    size, R = 0.0, reduced.R
    if len(priors):  # s is the noise of a row, whether or not the rows alone determine all parameters
        W, tau = R[:, :-1], R[:, -1]
        left = float(np.linalg.norm(tau - W @ scaled_lstsq(W, tau)))
        size = max(left, ROUNDING * float(np.linalg.norm(tau)), TINY) / math.sqrt(dof)
        R = factorize(np.vstack([R, size * priors]), 0, 0.0).R
    scale = column_scale(R[:count, :count])
    unit, z = R[:count, :count] / scale, R[:count, count]
    U, sigma, Vt = np.linalg.svd(unit)
    seen = sigma > RANK * sigma[0]
    believed = np.linalg.norm(size * priors[:, :-1] / scale @ Vt.T, axis=0) > 0.5 * sigma
    unseen = Vt[~seen & ~(believed & (sigma > TINY))]
    if len(unseen):
        raise _undetermined(unseen, [name for name, is_free in zip(names, free, strict=True) if is_free])
    values = Vt.T @ (U.T @ z / sigma) / scale
    bounded = np.zeros(count, dtype=np.bool_)
    if nonnegative is not None and (values[nonnegative[free]] < 0.0).any():
        lower = np.where(nonnegative[free], 0.0, -np.inf)
        found = scipy.optimize.lsq_linear(unit, z, (lower, np.inf), method="bvls", tol=1e-14)
        bounded = found.active_mask < 0
        values = np.where(bounded, 0.0, found.x / scale)
    V = Vt.T / sigma / scale[:, None]
    inverse = V @ V.T
    variance = size**2 if len(priors) else R[count, count] ** 2 / dof
    every = np.ix_(free, free)
    whole, noise = np.zeros((2, len(names), len(names)))
    whole[every], noise[every] = inverse, size**4 * priors[:, :-1].T @ priors[:, :-1]
    all_values[free] = values
    places = tuple(int(k) for k in np.flatnonzero(free)[bounded])
    condition = float(sigma[0] / sigma[-1])
    return Solution(all_values, variance * whole, condition, dof, whole, noise, places, sigma, Vt, np.flatnonzero(free))


def _undetermined(unseen: FloatArray, names: Sequence[str]) -> ExoidError:
    """Explain the directions, rows of ``unseen``, in which the regressor is zero."""
    reach = np.linalg.norm(unseen, axis=0)  # 1 where the parameter itself is unseen, whatever basis spans `unseen`
    alone = [name for name, part in zip(names, reach, strict=True) if part > 1.0 - INVOLVED**2]
    together = [n for n, part in zip(names, reach, strict=True) if part > INVOLVED and n not in alone]
    what = []
    if alone:
        what.append(f"{', '.join(alone)} left no trace in the torque")
    if together:
        what.append(f"{', '.join(together)} cannot be told apart in this motion")
    return NotIdentifiableError(
        f"the recordings do not determine every parameter: {'; '.join(what)}",
        remedy="move all joints at once, through different angles and speeds, leave out terms that cannot act, "
        "or say what is known of them (known, prior)",
        parameters=(*alone, *together),
    )
