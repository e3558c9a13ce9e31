"""Least squares by orthogonal factorisations, and which parameters the rows determine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .prior_knowledge import NO_PRIOR_KNOWLEDGE, PriorKnowledge
from .r_factor import RFactor, factorize

UNDETERMINED = 1e-7
"""Singular values of the unit-column regressor below this fraction of the largest count as zero."""

INVOLVED = 0.05
"""A parameter with less than this part in a direction that the rows do not see is not blamed for it."""

ROUNDING = 1e-9
"""Residuals below this part of the torque are rounding, and make no row surer."""

TINY = 1e-150
"""Smallest number to divide by."""


ILL_CONDITIONED = 100.0
"""Beyond this condition index an error of a thousandth of the torque may grow to a tenth of that of a parameter,"""

HOPELESS = 300.0
"""and beyond this to a third."""

LARGEST = 1e100
"""Condition indices are cut off here."""

HALF = 0.5
"""A parameter belongs to the directions that make up this part of its variance."""

NAMED = 3
"""So many groups of parameters are named."""

NAMED_PART = 0.2
"""A column with at least this part in a direction is named with it."""


class Direction(NamedTuple):
    """Parameters whose columns nearly cancel each other, those most involved first.

    Attributes:
        condition: Its condition index, the largest singular value of the unit-column regressor over its own.
        columns: Their indices.
    """

    condition: float
    columns: tuple[int, ...]


class Collinearity(NamedTuple):
    """What a least-squares problem says on parameters that it can hardly tell apart.

    Attributes:
        indices: Condition index of each parameter: at least half of its variance comes from directions of this index
            or worse, (P,); 1 for known parameters.
        directions: Those beyond :data:`ILL_CONDITIONED`, the worst first.
    """

    indices: FloatArray = np.ones(0)
    directions: tuple[Direction, ...] = ()

    @classmethod
    def of(cls, sigma: FloatArray, Vt: FloatArray, places: NDArray[np.intp], count: int) -> Collinearity:
        """Look at the singular value decomposition of a unit-column regressor.

        With singular values σ_k and right vectors v_k a parameter's variance is Σ_k v_ik² / σ_k²: each term over the
        sum is the variance-decomposition proportion of direction k.

        Args:
            sigma: Singular values, the largest first, (p,).
            Vt: Right singular vectors, (p, p).
            places: Of the columns among all parameters, (p,).
            count: Of all parameters, P.
        """
        worst_first, columns = np.minimum(sigma[0] / sigma[::-1], LARGEST), Vt[::-1]
        parts = (columns * worst_first[:, None]) ** 2
        summed = np.cumsum(parts, axis=0) / np.maximum(parts.sum(axis=0), np.finfo(np.float64).tiny)
        indices = np.ones(count)
        indices[places] = worst_first[np.argmax(summed >= HALF, axis=0)]
        directions = []
        for index, direction in zip(worst_first, np.abs(columns), strict=True):
            if index <= ILL_CONDITIONED:
                break
            order = np.argsort(-direction)
            named = [int(places[k]) for k in order if direction[k] >= NAMED_PART]
            directions.append(Direction(float(index), tuple(named)))
        return cls(indices, tuple(directions))

    def warnings(self, names: Sequence[str]) -> tuple[str, ...]:
        """Name the parameters that move together, in one sentence."""
        groups = [
            f"{', '.join(names[k] for k in direction.columns)} (condition index {direction.condition:.3g})"
            for direction in self.directions
        ]
        if not groups:
            return ()
        more = f"; and {len(groups) - NAMED} other groups" if len(groups) > NAMED else ""
        return (
            f"these recordings hardly tell apart {'; '.join(groups[:NAMED])}{more}: small errors of model, sensors or "
            "filters move them together by much, so excite more, or plan a motion",
        )


class Solution(NamedTuple):
    """Least-squares estimate with its evidence.

    Attributes:
        values: β, (P,).
        covariance: For independent noise of one size in all rows, as weighted, (P, P).
        condition_number: Of the regressor with columns scaled to unit length.
        dof: Independent samples less parameters.
        inverse: (WᵀW)⁻¹ of the rows as weighted, those of priors among them; zero for known parameters, (P, P).
        prior_noise: Share of the priors' own uncertainty in Wᵀ Γ W, (P, P).
        bounded: Indices of parameters that would have become negative.
        collinearity: Which parameters move together.
    """

    values: FloatArray
    covariance: FloatArray
    condition_number: float
    dof: float
    inverse: FloatArray
    prior_noise: FloatArray
    bounded: tuple[int, ...] = ()
    collinearity: Collinearity = Collinearity()

    def prior_gains(self, names: Sequence[str], prior_knowledge: PriorKnowledge) -> FloatArray:
        """How far parameters follow priors p, ∂β/∂p = (WᵀW)⁻¹ s² / σ² of rows (s/σ) β = (s/σ) p, (P, K)."""
        places = [list(names).index(name) for name in prior_knowledge.prior.values]
        std = np.array([std for _, std in prior_knowledge.prior.values.values()])
        return np.asarray(self.inverse[:, places] * (np.sqrt(np.diag(self.prior_noise)[places]) / std))


def solve(
    r_factor: RFactor,
    names: Sequence[str],
    prior_knowledge: PriorKnowledge = NO_PRIOR_KNOWLEDGE,
    nonnegative: NDArray[np.bool_] | None = None,
) -> Solution:
    """Minimise ‖W β − τ‖ (doc. 1, eq. (17), without its normal matrix).

    With columns scaled to unit length and R = U Σ Vᵀ, β = V Σ⁻¹ Uᵀ (Qᵀτ) and cov β = s² V Σ⁻² Vᵀ. Of m rows only m'
    carry independent noise, so that each residual counts m'/m: s² = ‖residual‖² / (m' − P).

    Known parameters leave the problem with their torque. A prior p ± σ becomes a row (s/σ) β = (s/σ) p: s is what a
    row of the recordings is worth, so that redundant rows do not outvote it.

    Args:
        r_factor: R of [W τ].
        names: Parameters, (P,).
        prior_knowledge: What is known beside the rows.
        nonnegative: Parameters that must not become negative, (P,); None if all may.

    Raises:
        ExoidError: Names the parameters that neither rows nor priors determine, and what to do.
    """
    free = prior_knowledge.free(names)
    if not free.any():
        raise ExoidError("every parameter is known: nothing is left to identify", remedy="leave some unknown")
    reduced = _without_known(r_factor, prior_knowledge.fixed_values(names), free)
    count = len(reduced.R) - 1
    dof = r_factor.samples - count
    if dof <= 0.0:
        raise ExoidError(
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
    seen = sigma > UNDETERMINED * sigma[0]
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
    together = Collinearity.of(sigma, Vt, np.flatnonzero(free), len(names))
    return Solution(all_values, variance * whole, float(sigma[0] / sigma[-1]), dof, whole, noise, places, together)


def _without_known(r_factor: RFactor, fixed: FloatArray, free: NDArray[np.bool_]) -> RFactor:
    """Take the torque of known parameters away, and their columns."""
    if free.all():
        return r_factor
    torque = r_factor.R @ np.append(-fixed, 1.0)
    return factorize(np.column_stack([r_factor.R[:, np.append(free, False)], torque]), 0, r_factor.samples)


def _row_noise(r_factor: RFactor, dof: float) -> float:
    """Size s of the noise of a row, counted as independent, whether or not the rows determine all parameters."""
    W, tau = r_factor.R[:, :-1], r_factor.R[:, -1]
    scale = np.linalg.norm(W, axis=0)
    W = W / np.where(scale > 0.0, scale, 1.0)
    fit, *_ = np.linalg.lstsq(W, tau, rcond=UNDETERMINED)
    residual = max(float(np.linalg.norm(tau - W @ fit)), ROUNDING * float(np.linalg.norm(tau)), TINY)
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
    return ExoidError(
        f"the recordings do not determine every parameter: {'; '.join(what)}",
        remedy="move all joints at once, through different angles and speeds, leave out terms that cannot act, "
        "or say what is known of them (known=, prior=)",
    )
