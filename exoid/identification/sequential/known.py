"""What is known after some steps of a sequential identification, and how one more step adds to it.

Each step of both documents explains the torque of one joint by parameters found before, which are taken as known, and a
few new ones: τ − W_k β_k = W_n β_n. What is uncertain about β_k is carried along:

    cov β_n = s² (W_nᵀ W_n)⁻¹ + G cov(β_k) Gᵀ,    cov(β_n, β_k) = −G cov(β_k),    G = (W_nᵀ W_n)⁻¹ W_nᵀ W_k.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

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

    def fit(
        self,
        columns: Mapping[str, FloatArray],
        tau: FloatArray,
        names: Sequence[str],
        nuisance: FloatArray | None = None,
        independence: float = 1.0,
    ) -> Known:
        """Find ``names`` from the torque of one joint, everything known held fixed and everything else taken as zero.

        Args:
            columns: Regressor column of each parameter that may act, (M,) each.
            tau: Torque [N·m], (M,).
            names: Parameters to find.
            nuisance: Columns of constants that are fitted and forgotten, (M, r).
            independence: Share of the rows that carries independent noise.

        Returns:
            What is known now.

        Raises:
            ExoidError: The rows do not determine the new parameters, or there are too few.
        """
        known = [name for name in self.names if name in columns]
        W_new = np.column_stack([columns[name] for name in names])
        W = W_new if nuisance is None else np.column_stack([W_new, nuisance])
        W_known = np.column_stack([columns[name] for name in known]) if known else np.zeros((len(tau), 0))
        index = [self.names.index(name) for name in known]
        inverse = _pseudo_inverse(W, names)
        rest = tau - W_known @ self.values[index]
        fitted = inverse @ rest
        dof = len(tau) * independence - W.shape[1]
        if dof <= 0.0:
            raise ExoidError(f"too few measurements for {', '.join(names)}: {len(tau)}", remedy="measure more poses")
        variance = float(np.sum((rest - W @ fitted) ** 2)) * independence / dof / independence
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
    U, sigma, Vt = np.linalg.svd(W / np.where(scale > 0.0, scale, 1.0), full_matrices=False)
    if sigma[-1] < DEPENDENT * sigma[0]:
        raise ExoidError(
            f"the measurements do not determine {', '.join(names)} one by one",
            remedy="choose poses or motions in which their effects differ",
        )
    return np.asarray((Vt.T / sigma) @ U.T / scale[:, None])
