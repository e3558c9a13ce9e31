"""R factors of the rows of each joint with the torques of all joints, which fits of other readings of a log share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.regression.least_squares import column_scale, scaled_lstsq
from exoid.regression.rows import form_rows, prepare
from exoid.signals import Poses, Recording
from exoid.torques import Motion

from .evidence import Evidence, r_factor
from .physics import never_negative
from .sample import FittedLeg


def torque_factors(fitted: FittedLeg, data: Iterable[Recording | Poses], *, weights: bool = False) -> list[FloatArray]:
    """R factors of rows [W τ₁ … τₙ], or [W G τ₁ … τₙ] with G that of gravity, n of (M, P + n) or (M, P + p + n)."""
    model, rigid = fitted.model, len(fitted.model.leg.parameter_names)
    tables: list[list[FloatArray]] = [[] for _ in model.leg.joint_names]
    for one in data:
        # torques may be another joint's, with other reversals: none is taken out
        prepared = prepare(model, one, fitted.preparation, stops=False)
        at_rest = None
        if weights:
            assert isinstance(prepared.motion, Motion)
            still = np.zeros_like(prepared.motion.v)
            at_rest = prepared._replace(motion=prepared.motion._replace(v=still, a=still))
        for stretch in prepared.stretches():
            rows = form_rows(model, prepared, stretch)
            gravity = form_rows(model, at_rest, stretch).W[..., :rigid] if at_rest else rows.W[..., :0]
            for j, table in enumerate(tables):
                table.append(np.column_stack([rows.W[:, j], gravity[:, j], rows.tau])[rows.usable[:, j]])
    return [r_factor(np.vstack(of_joint)) for of_joint in tables]


def torque_rows(evidence: Evidence, joint: int) -> FloatArray:
    """Rows [W τ₁ … τₙ] of a joint that a check has formed."""
    count = len(evidence.fixed)
    return np.vstack([np.hstack([one.W[:, joint, :count], one.tau])[one.usable[:, joint]] for one in evidence.parts])


def driven_joints(factors: Sequence[FloatArray]) -> list[bool]:
    """Joints with a torque other than zero: not those that are passive, or whose torque was not measured."""
    return [bool(R[:, R.shape[1] - len(factors) + j].any()) for j, R in enumerate(factors)]


def fit_torques(
    fitted: FittedLeg,
    of_joints: Sequence[FloatArray],
    order: Sequence[int] = (),
    factors: Sequence[float] = (),
    *,
    rounds: int = 3,
) -> tuple[FloatArray, FloatArray]:
    """Fit torques read otherwise: log residual/torque of each driven joint, and free values."""
    model, n, driven = fitted.model, len(of_joints), driven_joints(of_joints)
    order, factors = order or range(n), factors or (1.0,) * n
    count, free = len(model.names), ~np.isfinite(fitted.fixed)
    known = np.where(free, 0.0, fitted.fixed)
    rows = []
    for joint in np.flatnonzero(driven).tolist():
        R = of_joints[joint]
        rows.append((R[:, :count][:, free], factors[joint] * R[:, count + order[joint]] - R[:, :count] @ known))
    level = np.maximum(np.array([np.linalg.norm(t) for _, t in rows]), 1e-12)
    # All torques with the wrong sign would fit as well if what is positive in nature were not kept positive. Columns of
    # these, and of passive joints, that are zero, stand last: their rows of R, from which others are eliminated, below.
    last = never_negative(model)[free] | ~np.any([W.any(axis=0) for W, _ in rows], axis=0)
    columns, others = np.argsort(last, kind="stable"), int(np.count_nonzero(~last))
    weights, x = 1.0 / level, np.zeros(len(last))
    for _ in range(rounds):  # weights of the joints and residuals in turn
        pairs = zip(weights, rows, strict=True)
        R = r_factor(np.vstack([w * np.column_stack([W[:, columns], t]) for w, (W, t) in pairs]))
        scale = column_scale(R[:, :-1])
        A, b = R[:, :-1] / scale, R[:, -1]
        # without columns SciPy 1.17 frees memory twice, which ends the process
        positive = scipy.optimize.nnls(A[others:, others:], b[others:])[0] if len(last) > others else np.zeros(0)
        rest = scaled_lstsq(A[:, :others], b - A[:, others:] @ positive)
        x[columns] = np.append(rest, positive) / scale
        left = np.array([np.linalg.norm(t - W @ x) for W, t in rows])
        weights = 1.0 / np.maximum(left, 1e-6 * level)
    return np.log(np.maximum(left, 1e-6 * level) / level), x
