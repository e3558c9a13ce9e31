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

COLUMNS = 4
"""Columns that are factorised at once: of so few as a joint has, fastest."""


class RFactor(NamedTuple):
    """R factor of the QR factorisation of [W τ] of one joint: all that least squares needs of its rows.

    Attributes:
        R: Upper R factor, (P + 1, P + 1).
        rows: Number of rows that it stands for.
        samples: Number of independent samples among them.
        taken: R factor of what was taken out of the rows at reversals, (M, P + 1); None for nothing.
        all_rows: Number of rows with what was taken out.
    """

    R: FloatArray
    rows: int
    samples: float
    taken: FloatArray | None = None
    all_rows: int = 0

    def among(self, columns: NDArray[np.intp], width: int) -> RFactor:
        """Put the columns into the places that they have among so many, the others being zero.

        Args:
            columns: Index of each column among all.
            width: Number of all columns.

        Returns:
            The R factor, zero in the other columns.
        """
        R, taken = np.zeros((len(self.R), width)), None
        R[:, columns] = self.R
        if self.taken is not None:
            taken = np.zeros((len(self.taken), width))
            taken[:, columns] = self.taken
        return factorize(R, self.rows, self.samples)._replace(taken=taken, all_rows=self.all_rows)

    def residual(self, values: FloatArray) -> float:
        """Root of the sum of squared residuals ‖W β − τ‖ [N·m].

        Args:
            values: Parameters β, (P,).

        Returns:
            Norm of the residual [N·m].
        """
        return float(np.linalg.norm(self.R @ np.append(values, -1.0)))

    def whole_residual(self, values: FloatArray) -> float:
        """Root of the sum of squared residuals, with what was taken out of the rows at reversals.

        Args:
            values: Parameters β, (P,).

        Returns:
            Norm of the residual [N·m].
        """
        taken = 0.0 if self.taken is None else float(np.linalg.norm(self.taken @ np.append(values, -1.0)))
        return math.hypot(self.residual(values), taken)


def factorize_rows(rows: Rows) -> list[RFactor]:
    """Reduce the rows of each joint to a R factor."""
    r_factors = []
    for joint in range(rows.tau.shape[1]):
        columns, table = joint_table(rows, joint)
        count = table.shape[1]
        left, taken = (
            (rows.reversals[joint].noise_left * count, rows.reversals[joint].table) if rows.reversals else (count, None)
        )
        r_factor = factorize(table.T, round(left), left * rows.independent_fraction)
        r_factor = r_factor.among(columns, rows.W.shape[2] + 1)
        r_factors.append(r_factor._replace(taken=_triangle(taken), all_rows=count))
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
    factored, *_ = scipy.linalg.lapack.dgeqrt(min(COLUMNS, width), table)
    return RFactor(np.triu(factored[:width]), rows, samples)


def _triangle(table: FloatArray | None) -> FloatArray | None:
    """R factor of rows, (P + 1, P + 1) at most."""
    if table is None or len(table) <= table.shape[1]:
        return table
    return np.asarray(np.linalg.qr(table, mode="r"))


def rms_residual(r_factors: Sequence[RFactor], values: FloatArray) -> float:
    """RMS residual over the rows of several R factors, reversals included [N·m]."""
    squares = sum(r_factor.whole_residual(values) ** 2 for r_factor in r_factors)
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
    return stacked._replace(taken=_triangle(np.vstack(taken)) if taken else None, all_rows=all_rows)


def scaled_lstsq(A: FloatArray, b: FloatArray, rank: float = RANK) -> FloatArray:
    """Minimise ‖A x − b‖ with columns of unit length; x is zero in directions that count as unseen."""
    scale = np.linalg.norm(A, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    x, *_ = np.linalg.lstsq(A / scale, b, rcond=rank)
    return np.asarray((x.T / scale).T)


class Solution(NamedTuple):
    """Least-squares estimate with its evidence.

    Attributes:
        values: β, (P,).
        covariance: For independent noise of one size in all rows, as weighted, (P, P).
        condition_number: Condition number of the regressor with columns scaled to unit length.
        dof: Independent samples less parameters.
        inverse: (WᵀW)⁻¹ of the rows as weighted, those of priors among them; zero for known parameters, (P, P).
        prior_noise: Share of the priors' own uncertainty in Wᵀ Γ W, (P, P).
        bounded: Indices of parameters that would have become negative.
        sigma: Singular values of the regressor with columns scaled to unit length, the largest first, (p,).
        Vt: Its right singular vectors, (p, p).
        free: Indices of the p parameters that are not known.
    """

    values: FloatArray
    covariance: FloatArray
    condition_number: float
    dof: float
    inverse: FloatArray
    prior_noise: FloatArray
    bounded: tuple[int, ...] = ()
    sigma: FloatArray = np.ones(0)
    Vt: FloatArray = np.ones((0, 0))
    free: NDArray[np.intp] = np.zeros(0, dtype=np.intp)

    def prior_gains(self, names: Sequence[str], prior_knowledge: PriorKnowledge) -> FloatArray:
        """How far parameters follow priors p, ∂β/∂p = (WᵀW)⁻¹ s² / σ² of rows (s/σ) β = (s/σ) p, (P, K).

        Args:
            names: Names of the parameters, (P,).
            prior_knowledge: Prior knowledge with K priors.

        Returns:
            ∂β/∂p, (P, K).
        """
        places = [list(names).index(name) for name in prior_knowledge.prior.values]
        std = np.array([std for _, std in prior_knowledge.prior.values.values()])
        return np.asarray(self.inverse[:, places] * (np.sqrt(np.diag(self.prior_noise)[places]) / std))


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
    free = prior_knowledge.free(names)
    if not free.any():
        raise BadArgumentError("every parameter is known: nothing is left to identify", remedy="leave some unknown")
    reduced = r_factor
    if not free.all():
        torque = r_factor.R @ np.append(-prior_knowledge.fixed_values(names), 1.0)
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
    size = _row_noise(reduced, dof) if len(priors) else 0.0
    R = factorize(np.vstack([reduced.R, size * priors]), 0, 0.0).R if len(priors) else reduced.R
    scale = np.linalg.norm(R[:count, :count], axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
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
        values, bounded = _bounded(unit, z, scale, nonnegative[free])
    V = Vt.T / sigma / scale[:, None]
    inverse = V @ V.T
    variance = size**2 if len(priors) else R[count, count] ** 2 / dof
    every = np.ix_(free, free)
    whole, noise = np.zeros((2, len(names), len(names)))
    whole[every], noise[every] = inverse, size**4 * priors[:, :-1].T @ priors[:, :-1]
    all_values = prior_knowledge.fixed_values(names)
    all_values[free] = values
    places = tuple(int(k) for k in np.flatnonzero(free)[bounded])
    condition = float(sigma[0] / sigma[-1])
    return Solution(all_values, variance * whole, condition, dof, whole, noise, places, sigma, Vt, np.flatnonzero(free))


def _row_noise(r_factor: RFactor, dof: float) -> float:
    """Size s of the noise of a row, counted as independent, whether or not the rows determine all parameters."""
    W, tau = r_factor.R[:, :-1], r_factor.R[:, -1]
    left = float(np.linalg.norm(tau - W @ scaled_lstsq(W, tau)))
    residual = max(left, ROUNDING * float(np.linalg.norm(tau)), TINY)
    return residual / math.sqrt(dof)


def _bounded(
    unit: FloatArray, z: FloatArray, scale: FloatArray, nonnegative: NDArray[np.bool_]
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Minimise with some values not below zero, and say which are zero for that."""
    lower = np.where(nonnegative, 0.0, -np.inf)
    found = scipy.optimize.lsq_linear(unit, z, (lower, np.inf), method="bvls", tol=1e-14)
    bounded = found.active_mask < 0
    return np.where(bounded, 0.0, found.x / scale), bounded


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
        "or say what is known of them (known=, prior=)",
        parameters=(*alone, *together),
    )
