"""What is known after some steps of a sequential identification, and how one more step adds to it.

Each step of both documents explains the torque of one joint by parameters found before, which are taken as known, and a
few new ones: τ − W_k β_k = W_n β_n. What is uncertain about β_k is carried along:

    cov β_n = s² (W_nᵀ W_n)⁻¹ + G cov(β_k) Gᵀ,    cov(β_n, β_k) = −G cov(β_k),    G = (W_nᵀ W_n)⁻¹ W_nᵀ W_k.

This holds where no two steps look at the same torque samples, which is so in both documents.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .rows import JointRows

DEPENDENT = 1e-9
"""Singular values below this fraction of the largest count as zero."""


@dataclass(frozen=True, eq=False)
class Known:
    """Parameters found so far.

    Attributes:
        names: In the order they were found.
        values: (p,).
        covariance: (p, p).
    """

    names: tuple[str, ...] = ()
    values: FloatArray = field(default_factory=lambda: np.zeros(0))
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def std(self) -> FloatArray:
        """Standard deviations, (p,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def as_dict(self) -> dict[str, float]:
        """Values by name."""
        return dict(zip(self.names, self.values.tolist(), strict=True))

    def std_as_dict(self) -> dict[str, float]:
        """Standard deviations by name."""
        return dict(zip(self.names, self.std.tolist(), strict=True))

    def fit(self, rows: JointRows, names: Sequence[str], nuisance: FloatArray | None = None) -> Known:
        """Find ``names`` from the torque of one joint, everything known held fixed and everything else taken as zero.

        Args:
            rows: Of the joint; columns that are neither known nor to be found do not act.
            names: Parameters to find.
            nuisance: Columns of constants that are fitted and forgotten, (M, r).

        Returns:
            What is known now.

        Raises:
            ExoidError: A parameter is known already, or the rows do not determine it, or there are too few.
        """
        again = [name for name in names if name in self.names]
        if again:
            raise ExoidError(f"{', '.join(again)} is known already", remedy="start from what was known before")
        W_new = np.column_stack([rows.columns[name] for name in names])
        W = W_new if nuisance is None else np.column_stack([W_new, nuisance])
        dof = len(rows.tau) * rows.independent_fraction - W.shape[1]
        if dof <= 0.0:
            raise ExoidError(
                f"too few measurements for {', '.join(names)}: {len(rows.tau)}", remedy="measure more poses or longer"
            )
        inverse = _pseudo_inverse(W, names)
        rest = rows.tau - rows.explained(self.as_dict())
        fitted = inverse @ rest
        variance = float(np.sum((rest - W @ fitted) ** 2)) / dof  # of an independent row, per row
        return self._extended(rows, names, fitted, inverse, variance)

    def _extended(
        self, rows: JointRows, names: Sequence[str], fitted: FloatArray, inverse: FloatArray, variance: float
    ) -> Known:
        """Add the first of the fitted values, and carry what is uncertain about those known before."""
        index = [k for k, name in enumerate(self.names) if name in rows.columns]
        acting = [rows.columns[self.names[k]] for k in index]
        W_known = np.column_stack(acting) if acting else np.zeros((len(rows.tau), 0))
        p = len(names)
        gain = (inverse @ W_known)[:p]
        cross = -gain @ self.covariance[index]
        own = variance * (inverse @ inverse.T)[:p, :p] + gain @ self.covariance[np.ix_(index, index)] @ gain.T
        return Known(
            (*self.names, *names),
            np.concatenate([self.values, fitted[:p]]),
            np.block([[self.covariance, cross.T], [cross, own]]),
        )


def _pseudo_inverse(W: FloatArray, names: Sequence[str]) -> FloatArray:
    scale = np.linalg.norm(W, axis=0)
    scale[scale == 0.0] = 1.0
    U, sigma, Vt = np.linalg.svd(W / scale, full_matrices=False)
    if sigma[-1] <= DEPENDENT * sigma[0]:
        raise ExoidError(
            f"the measurements do not determine {', '.join(names)} one by one",
            remedy="choose poses or motions in which their effects differ",
        )
    return np.asarray((Vt.T / sigma) @ U.T / scale[:, None])
