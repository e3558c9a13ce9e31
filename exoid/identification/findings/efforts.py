"""Torques that are logged otherwise: fits of them, magnitudes, and efforts of robots that leave gravity out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding
from exoid.identification.group_rows import Data
from exoid.regression.least_squares import column_scale, scaled_lstsq
from exoid.regression.rows import decimated, form_rows, prepare
from exoid.signals import Recording
from exoid.torques import Motion

from .evidence import Evidence, r_factor
from .physics import CheckedFit, never_negative
from .sample import FittedLeg

POOR = 0.2  # other readings of the log are worth trying where the model leaves so large a part of a torque
FITS_BETTER, CLEARLY = 1.6, 1.1
"""Residuals of two joints are together so many times smaller (geometric mean) in another reading of a log, however many
joints there are; and in one that is more far-fetched than another."""


def torque_factors(fitted: FittedLeg, data: Data, *, weights: bool = False, few: bool = False) -> list[FloatArray]:
    """R factors of rows [W τ₁ … τₙ], or [W G τ₁ … τₙ] with G that of gravity, n of (M, P + n) or (M, P + p + n)."""
    model, rigid = fitted.model, len(fitted.model.leg.parameter_names)
    tables: list[list[FloatArray]] = [[] for _ in model.leg.joint_names]
    for one in data:
        # torques may be another joint's, with other reversals: none is taken out
        prepared = prepare(model, one, fitted.preparation, stops=False)
        if few:
            prepared = decimated(prepared)
            part = prepared.rows[: max(250, len(prepared.rows) // 4)]
            prepared = prepared._replace(rows=part) if prepared.usable[part].any() else prepared
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
    factors: Sequence[float] = (),
    *,
    rounds: int = 3,
) -> tuple[FloatArray, FloatArray]:
    """Fit torques read otherwise: log residual/torque of each driven joint, and free values."""
    model, n, driven = fitted.model, len(of_joints), driven_joints(of_joints)
    factors = factors or (1.0,) * n
    count, free = len(model.names), ~np.isfinite(fitted.fixed)
    known = np.where(free, 0.0, fitted.fixed)
    rows = []
    for joint in np.flatnonzero(driven).tolist():
        R = of_joints[joint]
        rows.append((R[:, :count][:, free], factors[joint] * R[:, count + joint] - R[:, :count] @ known))
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


def unsigned_torques(checked: CheckedFit) -> Iterator[Finding]:
    """Give torques of one sign the signs of a fit, beginning with the URDF's, and see whether it becomes far better."""
    fitted, model, free = checked.fitted, checked.fitted.model, ~np.isfinite(checked.fitted.fixed)
    count, urdf, solution = len(model.names), model.leg.parameters, np.nan_to_num(fitted.fixed)
    inside = [one.mask if isinstance(one, Recording) and one.mask is not None else ... for one in fitted.data]
    logged = np.vstack([one.tau[part] for one, part in zip(fitted.data, inside, strict=True) if one.tau is not None])
    low, high, size = logged.min(axis=0), logged.max(axis=0), np.abs(logged)
    alike, poor = low * high >= 0.0, checked.nrmse > 0.25 * POOR
    if not (alike & poor & (size.min(axis=0) < 0.1 * size.std(axis=0))).any():  # one that stays off zero has a sign
        return
    rows = [torque_rows(checked.evidence, j) for j in range(len(alike))]
    plain = [r_factor(of_joint) for of_joint in rows]
    driven, factors = driven_joints(plain), list(plain)
    signs = {j: np.sign(rows[j][:, : len(urdf)] @ urdf) for j in np.flatnonzero(alike & driven).tolist()}
    for _ in range(15):  # signs and parameters in turn; half of that settles most logs
        for j, sign in signs.items():
            columns = rows[j].copy()
            columns[:, count + j] *= sign
            factors[j] = r_factor(columns)
        signed, solution[free] = fit_torques(fitted, factors)
        predicted = {j: np.where(rows[j][:, :count] @ solution < 0.0, -1.0, 1.0) for j in signs}
        if all(np.array_equal(predicted[j], sign) for j, sign in signs.items()):
            break
        signs = predicted
    as_logged, _ = fit_torques(fitted, plain)
    better = dict(zip(np.flatnonzero(driven).tolist(), np.exp(as_logged - signed).tolist(), strict=True))
    turned = {j: float(np.mean(sign < 0.0)) for j, sign in signs.items()}
    if not any(better[j] > FITS_BETTER and 0.02 < share < 0.98 for j, share in turned.items()):
        return
    for j, share in turned.items():
        if share > 0.02 and (share < 0.98 or better[j] > CLEARLY):
            ratio = f"residuals are {better[j]:.3g} times smaller with that sign"
            message = f"the torque is logged as a magnitude: the model's is negative {share:.0%} of the time; {ratio}"
            remedy, joint = "log torque or current with its sign", model.leg.joint_names[j]
            names = tuple(np.array(model.names)[model.acting[j]].tolist())
            yield Finding("unsigned-torque", joint, share, "1", "error", message, remedy, parameters=names)


def missing_gravity(checked: CheckedFit) -> Iterator[Finding]:
    """Fit the URDF's gravity and inertial torques with a factor each: only the latter may be in the log."""
    fitted, model, evidence = checked.fitted, checked.fitted.model, checked.evidence
    count, urdf = len(model.names), model.leg.parameters
    rigid, n = len(urdf), len(model.leg.joint_names)
    small = [np.linalg.norm(R[:, :rigid] @ urdf) > 1.5 * np.linalg.norm(R[:, -1]) for R in evidence.factors]
    moved = any(isinstance(one, Recording) and one.base is not None for one in fitted.data)
    if moved or not ((checked.nrmse > POOR).any() or checked.below.any() or any(small)):
        return
    every = torque_factors(fitted, fitted.data, weights=True)
    measured = [j for j, driven in enumerate(driven_joints(every)) if driven]
    parts = []
    for j in measured:
        R = every[j]
        weight = R[:, count : count + rigid] @ urdf
        parts.append(np.column_stack([weight, R[:, :rigid] @ urdf - weight, R[:, rigid:count], R[:, j - n]]))
    chosen = evidence._replace(factors=parts, counts=evidence.counts[measured], fixed=np.zeros(0))
    weights = chosen.weights(np.arange(parts[0].shape[1] - 1))
    rows = np.vstack([w * part for w, part in zip(weights, parts, strict=True)])
    gravity, inertia = scaled_lstsq(rows[:, :-1], rows[:, -1])[:2].tolist()
    sizes = np.array([np.linalg.norm(part, axis=0) for part in parts])
    seen = (inertia * sizes[:, :2] > 0.1 * sizes[:, -1:]).any(axis=0)
    if not seen.all() or abs(gravity) > 0.15 * inertia:
        return
    parted = [np.split(R, [rigid, count, count + rigid], axis=1) for R in every]
    full, bare = ([np.hstack([W - g * G, rest, tau]) for W, rest, G, tau in parted] for g in (0.0, 1.0))
    left, less = (fit_torques(fitted, torques)[0].mean() for torques in (full, bare))
    if less > left + np.log(1.2):  # gravity may point elsewhere
        return
    share = gravity / inertia
    part = f"{abs(share):.0%} of the gravity torque that goes with their inertial part"
    message = f"the torques contain {part}: they are efforts without gravity, or the leg lies on its side"
    remedy = "log currents or raw torques, add the controller's gravity torque, or turn the base in the URDF"
    yield Finding("gravity-compensated-effort", "", share, "1", "error", message, remedy, parameters=model.names)
