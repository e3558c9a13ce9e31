"""Sequential identification: rows of one joint, the estimate, and the least-squares step that extends it.

Each step of both documents explains the torque of one joint by known parameters β_k of earlier steps and a few new ones
β_n: τ − W_k β_k = W_n β_n. The uncertainty of β_k is propagated:

    cov β_n = s² (W_nᵀ W_n)⁻¹ + G cov(β_k) Gᵀ,    cov(β_n, β_k) = −G cov(β_k),    G = (W_nᵀ W_n)⁻¹ W_nᵀ W_k.

This holds if no two steps use the same torque samples, which is true in both documents.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError
from exoid.leg.leg import Leg
from exoid.regression.every_row import make_rows
from exoid.regression.least_squares import RANK, column_scale
from exoid.signals import FiniteDifference, Poses, Preparation, Recording
from exoid.torques import Term, TorqueModel


class JointRows(NamedTuple):
    """Rows of the torque equation of one joint."""

    columns: Mapping[str, FloatArray]  # regressor column of every parameter, (M,) each
    tau: FloatArray  # measured torque [N·m], (M,)
    v: FloatArray  # velocity of the joint [rad/s], (M,)
    independent_fraction: float = 1.0  # share of the rows that carries independent noise; a filter leaves fewer

    def where(self, mask: NDArray[np.bool_]) -> JointRows:
        """Select the rows of a mask, (M,)."""
        columns = {name: column[mask] for name, column in self.columns.items()}
        return JointRows(columns, self.tau[mask], self.v[mask], self.independent_fraction)

    def neglecting(self, prefix: str) -> JointRows:
        """Set the parameters whose names have this prefix to zero."""
        columns = {name: column for name, column in self.columns.items() if not name.startswith(prefix)}
        return self._replace(columns=columns)

    def mean_of_pairs(self) -> JointRows:
        """Average rows in consecutive pairs."""
        columns = {name: 0.5 * (column[0::2] + column[1::2]) for name, column in self.columns.items()}
        return self._replace(columns=columns, tau=0.5 * (self.tau[0::2] + self.tau[1::2]), v=self.v[0::2])

    def explained(self, values: Mapping[str, float], without: Sequence[str] = ()) -> FloatArray:
        """Compute the torque of some parameters [N·m], (M,), except those of ``without``."""
        named = [name for name in values if name in self.columns and name not in without]
        return np.asarray(sum((values[name] * self.columns[name] for name in named), np.zeros_like(self.tau)))


@dataclass(frozen=True, eq=False, repr=False)
class SequentialEstimate:
    """Parameters identified so far."""

    names: tuple[str, ...] = ()  # names in the order of identification
    values: FloatArray = field(default_factory=lambda: np.zeros(0))  # values, (p,)
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))  # covariance, (p, p)

    @property
    def std(self) -> FloatArray:
        """Standard deviations, (p,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def as_dict(self) -> dict[str, float]:
        """Return the values by name."""
        return dict(zip(self.names, self.values.tolist(), strict=True))

    def fit(self, rows: JointRows, names: Sequence[str], nuisance: FloatArray | None = None) -> SequentialEstimate:
        """Identify parameters from the torque of one joint, with known parameters fixed and all others zero."""
        again = [name for name in names if name in self.names]
        if again:
            raise BadArgumentError(f"{', '.join(again)} is known already", remedy="start from an earlier estimate")
        W_new = np.column_stack([rows.columns[name] for name in names])
        W = W_new if nuisance is None else np.column_stack([W_new, nuisance])
        dof = len(rows.tau) * rows.independent_fraction - W.shape[1]
        if dof <= 0.0:
            raise NotIdentifiableError(
                f"too few measurements for {', '.join(names)}: {len(rows.tau)}",
                parameters=tuple(names),
                remedy="measure more poses or longer",
            )
        scale = column_scale(W)
        U, sigma, Vt = np.linalg.svd(W / scale, full_matrices=False)
        if sigma[-1] <= RANK * sigma[0]:
            raise NotIdentifiableError(
                f"the measurements do not determine {', '.join(names)} one by one",
                parameters=tuple(names),
                remedy="choose poses or motions in which their effects differ",
            )
        inverse = (Vt.T / sigma) @ U.T / scale[:, None]
        rest = rows.tau - rows.explained(self.as_dict())
        fitted = inverse @ rest
        variance = float(np.sum((rest - W @ fitted) ** 2)) / dof  # per independent row
        return self._extended(rows, names, fitted, inverse, variance)

    def _extended(
        self, rows: JointRows, names: Sequence[str], fitted: FloatArray, inverse: FloatArray, variance: float
    ) -> SequentialEstimate:
        """Append the fitted parameters without nuisance, and propagate the uncertainty of the known ones."""
        index = [k for k, name in enumerate(self.names) if name in rows.columns]
        acting = [rows.columns[self.names[k]] for k in index]
        W_known = np.column_stack(acting) if acting else np.zeros((len(rows.tau), 0))
        p = len(names)
        gain = (inverse @ W_known)[:p]
        cross = -gain @ self.covariance[index]
        own = variance * (inverse @ inverse.T)[:p, :p] + gain @ self.covariance[np.ix_(index, index)] @ gain.T
        return SequentialEstimate(
            (*self.names, *names),
            np.concatenate([self.values, fitted[:p]]),
            np.block([[self.covariance, cross.T], [cross, own]]),
        )


def rows_at_rest(model: TorqueModel, poses: Poses, joint: int) -> JointRows:
    """Make the rows of a joint in static poses."""
    rows = make_rows(model, poses, FiniteDifference())
    columns = dict(zip(model.names, rows.W[:, joint].T, strict=True))
    return JointRows(columns, rows.tau[:, joint], np.zeros(len(rows.tau)))


def rows_in_motion(
    model: TorqueModel, recordings: Sequence[Recording], joint: int, preparation: Preparation
) -> JointRows:
    """Make the rows of a joint in several recordings, in sequence."""
    if not recordings:
        raise BadArgumentError("no recordings", remedy="pass at least one")
    each = [make_rows(model, recording, preparation) for recording in recordings]
    W, tau, v = (np.concatenate([getattr(rows, name)[:, joint] for rows in each]) for name in ("W", "tau", "v"))
    columns = dict(zip(model.names, W.T, strict=True))
    return JointRows(columns, tau, v, min(rows.independent_fraction for rows in each))


def planar_model(leg: Leg, joints: Sequence[str], document: int, terms: Sequence[Term]) -> TorqueModel:
    """Make the torque model of a document's procedure."""
    if leg.chain is None or leg.chain.n != len(joints):
        raise NotSupportedError(
            f"document {document}'s procedure needs a planar leg of {', '.join(joints[:-1])} and {joints[-1]}",
            where=leg.description.name,
            remedy="use exoid.identify, which works for any leg",
        )
    return TorqueModel(leg, tuple(terms))
