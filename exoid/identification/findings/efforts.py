"""Torques that are logged as magnitudes, and those that leave gravity out, as a robot's own "effort" may do."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid.estimate.finding import Finding
from exoid.regression.least_squares import scaled_lstsq
from exoid.signals import Recording

from .evidence import r_factor
from .factors import driven_joints, fit_torques, torque_factors, torque_rows
from .physics import CheckedFit
from .readings import CLEARLY, FITS_BETTER, POOR


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
            message = (
                f"the torque is logged as a magnitude: by the model it is negative {share:.0%} of the time; "
                f"residuals are {better[j]:.3g} times smaller with that sign"
            )
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
