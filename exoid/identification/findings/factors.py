"""R factors of the rows of each joint with the torques of all joints, which fits of other readings of a log share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.least_squares import column_scale, scaled_lstsq
from exoid.regression.rows import form_rows, prepare
from exoid.signals import Poses, Recording
from exoid.torques import TorqueModel

from .evidence import r_factor
from .sample import FittedLeg


class TorqueFit(NamedTuple):
    """Fit of a reading of a log."""

    misfit: float  # mean logarithm of residual over torque of the joints
    # shares of each other's torque in two joints whose torques are mixed; empty where none are
    shares: tuple[float, ...] = ()


class TorqueFactors(NamedTuple):
    """R factors of the rows of each joint with the torques of all joints, [W τ₁ … τₙ]."""

    of_joints: list[FloatArray]  # R factor of each joint, (M, P + n)

    @classmethod
    def of(cls, fitted: FittedLeg, data: Iterable[Recording | Poses]) -> TorqueFactors:
        """Form the rows of recordings."""
        model = fitted.model
        joints = range(len(model.joint_names))
        tables: list[list[FloatArray]] = [[] for _ in joints]
        for one in data:
            prepared = prepare(model, one, fitted.preparation)
            prepared = prepared._replace(reversals=None)  # torques may be another joint's, with other reversals
            for stretch in prepared.stretches():
                rows = form_rows(model, prepared, stretch)
                for j in joints:
                    tables[j].append(np.column_stack([rows.W[:, j], rows.tau])[rows.usable[:, j]])
        return cls([r_factor(np.vstack(of_joint)) for of_joint in tables])

    @property
    def driven(self) -> list[bool]:
        """Joints with a torque other than zero: not those that are passive, or whose torque was not measured."""
        joints = len(self.of_joints)
        return [bool(R[:, R.shape[1] - joints + j].any()) for j, R in enumerate(self.of_joints)]

    def fit(
        self,
        fitted: FittedLeg,
        order: Sequence[int] = (),
        factors: Sequence[float] = (),
        mixed: tuple[int, int] | None = None,
    ) -> TorqueFit:
        """Fit the torques, read otherwise, or those of two joints with a share of each other's torque."""
        model, n = fitted.model, len(self.of_joints)
        order, factors = order or range(n), factors or (1.0,) * n
        count, free = len(model.names), ~np.isfinite(fitted.fixed)
        known = np.where(free, 0.0, fitted.fixed)
        rows = []
        for joint, (R, source, factor) in enumerate(zip(self.of_joints, order, factors, strict=True)):
            if not R[:, count + joint].any():
                continue
            W = R[:, :count][:, free]
            if mixed is not None:
                W = np.column_stack([W, *(-R[:, count + k] * (j == joint) for j, k in (mixed, mixed[::-1]))])
            rows.append((W, factor * R[:, count + source] - R[:, :count] @ known))
        level = np.maximum(np.array([np.linalg.norm(t) for _, t in rows]), 1e-12)
        # All torques with the wrong sign would fit as well if what is positive in nature were not kept positive.
        lower = np.where(never_negative(model)[free], 0.0, -np.inf)
        lower = lower if mixed is None else np.append(lower, (-np.inf, -np.inf))
        weights = 1.0 / level
        for _ in range(3):  # weights of the joints and residuals in turn
            A = np.vstack([w * W for w, (W, _) in zip(weights, rows, strict=True)])
            b = np.concatenate([w * t for w, (_, t) in zip(weights, rows, strict=True)])
            x = _bounded(A, b, lower)
            left = np.array([np.linalg.norm(t - W @ x) for W, t in rows])
            weights = 1.0 / np.maximum(left, 1e-6 * level)
        misfit = float(np.mean(np.log(np.maximum(left, 1e-6 * level) / level)))
        return TorqueFit(misfit, () if mixed is None else (float(x[-2]), float(x[-1])))


def _bounded(A: FloatArray, b: FloatArray, lower: FloatArray) -> FloatArray:
    """Least squares with some values not below zero, columns scaled to unit length."""
    x = scaled_lstsq(A, b)
    if (x < lower).any():
        scale = column_scale(A)
        R = r_factor(np.column_stack([A / scale, b]))
        x = scipy.optimize.lsq_linear(R[:, :-1], R[:, -1], (lower, np.inf), method="bvls", tol=1e-8).x / scale
    return np.asarray(x)


def never_negative(model: TorqueModel) -> NDArray[np.bool_]:
    """Find the parameters that cannot be negative: friction, rotor inertia, J of planar segments and the total mass."""
    rigid = set(model.leg.parameter_names) if model.leg.limbs else set()
    inertia = [name in rigid and name[0] in "JM" for name in model.names]
    return np.asarray(model.nonnegative | np.array(inertia))
