"""Least squares by orthogonal factorisations, and which parameters the rows determine."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .rows import Triangle

UNDETERMINED = 1e-7
"""Singular values of the unit-column regressor below this fraction of the largest count as zero."""

INVOLVED = 0.05
"""A parameter with less than this part in a direction that the rows do not see is not blamed for it."""


class Solution(NamedTuple):
    """Least-squares estimate with its evidence.

    Attributes:
        values: β, (P,).
        covariance: For independent noise of one size in all rows, as weighted, (P, P).
        condition_number: Of the regressor with columns scaled to unit length.
        dof: Independent samples less parameters.
        inverse: (WᵀW)⁻¹ of the rows as weighted, (P, P).
    """

    values: FloatArray
    covariance: FloatArray
    condition_number: float
    dof: float
    inverse: FloatArray


def solve(triangle: Triangle, names: Sequence[str]) -> Solution:
    """Minimise ‖W β − τ‖ (doc. 1, eq. (17), without its normal matrix).

    With columns scaled to unit length and R = U Σ Vᵀ, β = V Σ⁻¹ Uᵀ (Qᵀτ) and cov β = s² V Σ⁻² Vᵀ. Of m rows only m'
    carry independent noise, so that each residual counts m'/m: s² = ‖residual‖² / (m' − P).

    Args:
        triangle: R of [W τ].
        names: Parameters, (P,).

    Raises:
        ExoidError: Names the parameters that the rows do not determine, and what to do.
    """
    count = len(names)
    R, z, rest = triangle.R[:count, :count], triangle.R[:count, count], triangle.R[count, count]
    dof = triangle.samples - count
    if dof <= 0.0:
        raise ExoidError(
            f"too few samples: {triangle.samples:.0f} independent ones for {count} parameters",
            remedy="record longer, or raise the cut-off",
        )
    scale = np.linalg.norm(R, axis=0)
    unit = R / np.where(scale > 0.0, scale, 1.0)
    U, sigma, Vt = np.linalg.svd(unit)
    unseen = Vt[sigma < UNDETERMINED * sigma[0]]
    if len(unseen):
        raise _undetermined(unseen, names)
    V = Vt.T / sigma / scale[:, None]
    inverse = V @ V.T
    return Solution(V @ (U.T @ z), rest**2 / dof * inverse, float(sigma[0] / sigma[-1]), dof, inverse)


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
        remedy="move all joints at once, through different angles and speeds, or leave out terms that cannot act",
    )
