"""Checks against the URDF and physics: the scale of the torque, legs that cannot exist, legs far from their drawing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.finding import SEVERITIES, Finding, Severity, ordered
from exoid.leg.leg import Leg
from exoid.leg.lift import check_physical
from exoid.leg.lift.lift import nearest_within
from exoid.leg.lift.pseudo_inertia import margins
from exoid.regression.least_squares import RFactor, scaled_lstsq
from exoid.torques import TorqueModel

from .evidence import Evidence, torque_shares
from .sample import FittedLeg

IMPOSSIBLE = 4.5  # standard deviations of one parameter that no leg can have from the nearest that one can


class CheckedFit(NamedTuple):
    """A fit with the rows that its checks look at, and the residuals on them, joint by joint."""

    fitted: FittedLeg  # the fit, and a sample of its data
    evidence: Evidence  # rows of the sample
    below: NDArray[np.bool_]  # parameters that are negative although they cannot be, (P,)
    spread: FloatArray  # standard deviation of the torque [N·m], 0 for a joint without rows, (n,)
    nrmse: FloatArray  # RMS residual over that, (n,)
    # correlation of residuals from one row to the next: near 0 for noise of a sensor, near 1 for a motion, (n,)
    persistence: FloatArray
    residuals: list[FloatArray]  # of each recording, or zero for poses, (N, n) [N·m]

    @classmethod
    def of(cls, fitted: FittedLeg, evidence: Evidence) -> CheckedFit:
        """Compute residuals on the rows of a check."""
        # Behind the filter, rows are about as far apart as the samples that carry independent noise.
        values, parts, n = fitted.values, evidence.parts, len(evidence.counts)
        left = [np.where(part.usable, part.tau - part.W[..., : len(values)] @ values, 0.0) for part in parts]
        torques = [np.concatenate([part.tau[part.usable[:, j], j] for part in parts]) for j in range(n)]
        spread = np.array([np.std(x) if len(x) else 0.0 for x in torques])
        rms = np.sqrt(np.sum([np.sum(x**2, axis=0) for x in left], axis=0) / evidence.counts)
        moving = [x * (not rest) for x, rest in zip(left, evidence.at_rest, strict=True)]
        power = np.sum([np.sum(x**2, axis=0) for x in moving], axis=0)
        product = np.sum([np.sum(x[1:] * x[:-1], axis=0) for x in moving], axis=0)
        std = np.sqrt(np.maximum(np.diag(fitted.covariance), 0.0))
        # by more than their errors and 2 % of the torque
        shares = torque_shares(evidence.factors, np.arange(len(values)), np.diag(values))
        below = (values < -IMPOSSIBLE * std) & (values < 0.0) & (shares > 0.02) & never_negative(fitted.model)
        nrmse = np.divide(rms, spread, out=np.zeros(n), where=spread > 0.0)
        persistence = product / np.maximum(power, np.finfo(float).tiny)
        return cls(fitted, evidence, below, spread, nrmse, persistence, moving)


def odd_scales(model: TorqueModel, factors: Iterable[FloatArray]) -> dict[str, float]:
    """Torques over three times those of the URDF's inertias, or less, friction left free; "" for all joints."""
    urdf, rigid = model.leg.parameters, len(model.leg.parameter_names)
    scales: dict[str, float] = {}
    for j, (joint, label, R) in enumerate(zip(model.leg.joint_names, model.leg.joint_labels, factors, strict=True)):
        terms = np.flatnonzero(model.acting[j, rigid:]) + rigid
        # A rotor that counts as inertia of a link is in no URDF: where gravity does not act, it is most of the torque.
        rotors = [name for one in model.regrouped if one.name == f"Ia_{label}" for name in one.into]
        terms = np.append(terms, [k for k, name in enumerate(model.names) if name in rotors]).astype(np.intp)
        expected, torque = R[:, :rigid] @ urdf, R[:, -1]
        A = np.column_stack([expected, R[:, terms]])
        if not A.any(axis=0).all():
            continue
        x, whole = scaled_lstsq(A, torque), max(float(np.linalg.norm(torque)), 1e-300)
        scale, left = float(x[0]), float(np.linalg.norm(torque - A @ x)) / whole
        # Rigid bodies are to show, and with friction to explain most of the torque.
        if abs(scale) * np.linalg.norm(expected) / whole > 0.1 and left < 0.4:
            scales[joint] = scale
    odd = {joint: scale for joint, scale in scales.items() if abs(np.log(abs(scale))) > np.log(3.0)}
    sizes = np.abs(list(odd.values()))
    if len(odd) > 1 and len(odd) == len(scales) and sizes.max() < 2.0 * sizes.min():
        return {"": float(np.exp(np.mean(np.log(sizes))))}
    return odd


def torque_scale(checked: CheckedFit) -> Iterator[Finding]:
    """Compare the torque of each joint with that of the URDF's inertias."""
    model = checked.fitted.model
    for joint, signed in odd_scales(model, checked.evidence.factors).items():
        finding = other_scale(joint, abs(signed), model.names)
        if joint and finding.severity == "warning":
            scaled = [R.copy() for R in checked.evidence.factors]
            scaled[model.leg.joint_names.index(joint)][:, -1] /= abs(signed)
            both = checked.evidence, checked.evidence._replace(factors=scaled)
            plain, other = (one.weights(one.free) for one in both)
            # relative residuals of all joints grow, or hardly shrink: the others contradict this scale
            if np.log(plain / other).sum() + np.log(abs(signed)) > -np.log(1.1):
                finding = replace(finding, severity="info")
        yield finding


def mass_scale(leg: Leg, values: FloatArray, names: tuple[str, ...]) -> Iterator[Finding]:
    """Compare the mass of a whole machine, the first parameter of a floating base, with that of the URDF."""
    if leg.base_rows and values[0] > 0.0 and abs(np.log(values[0] / leg.parameters[0])) > np.log(3.0):
        yield other_scale("", float(values[0] / leg.parameters[0]), names)


def other_scale(joint: str, size: float, names: tuple[str, ...]) -> Finding:
    """Say that the torque of one joint, or of all, does not fit the URDF."""
    looks = "as another unit would make it"
    if 300.0 < size < 3000.0:
        looks = "as N·mm would be, or a current in mA times N·m per A"
    elif size < 1.0:
        looks = "as the torque of the motor in front of a gear, or a current in amperes, would be"
    torques = f"the torque of {joint} is" if joint else "all torques are"
    message = f"{torques} {size:.3g} times what the URDF's inertias ask for, {looks}; the log alone cannot tell"
    remedy = (
        "convert the torque to N·m at the joint by the unit or the scale of its column (a current: N·m per A, "
        "tau_<joint>=HEADER:SCALE); if it is right, the URDF's inertias are wrong"
    )
    # Inertias of a CAD model are wrong five-fold, not a hundred-fold: only that must be the unit. The torques of
    # other joints ask for another scale if it is one joint's unit, and for none if it is a body's mass.
    severity: Severity = "error" if not 0.05 < size < 20.0 else "warning"
    return Finding("torque-scale", joint, size, "1", severity, message, remedy, parameters=names)


def impossible_leg(
    leg: Leg, values: FloatArray, covariance: FloatArray, factors: Iterable[FloatArray]
) -> Iterator[Finding]:
    """Find parameters that no leg can have, by more than their errors, given the R factor of each joint's rows."""
    rigid = len(leg.parameter_names)
    bodies, errors = values[:rigid], covariance[:rigid, :rigid]
    reasons = check_physical(leg, bodies).reasons if leg.chain is not None else ("densities would be negative",)
    if not reasons:
        return
    try:
        apart = 0.0  # standard deviations by which the centre of mass of a segment is on the wrong side of its joint
        for start in range(rigid - 3 * len(leg.joint_names), rigid, 3) if leg.limbs else ():
            place, direction = slice(start, start + 2), leg.parameters[start : start + 2]
            std = float(np.sqrt(direction @ errors[place, place] @ direction))
            apart = max(apart, -float(direction @ bodies[place]) / std if std > 0.0 else 0.0)
        links = leg.reduction.adjust(leg.link_parameters, bodies)
        if apart < IMPOSSIBLE and (margins(links) > 0.0).all():  # the leg's own links, changed a little, have them
            return
        tables = [np.column_stack([R[:, : len(covariance)], R[:, -1]]) for R in factors]
        # The true leg is at least as far away as the nearest possible one, and its distance squared is χ² of all
        # parameters: of 57 it exceeds 4.5² nearly always, and this limit as seldom as one parameter exceeds 4.5.
        limit = float(np.sqrt(scipy.special.chdtri(rigid, 2.0 * scipy.special.ndtr(-IMPOSSIBLE))))
        nearest, distance = nearest_within(leg, bodies, errors, limit)
        change = torque_shares(tables, np.arange(rigid), np.diag(bodies - nearest)).max()
        if apart < IMPOSSIBLE and (distance < limit or change < 5e-3):  # part of a joint's torque that would show
            return
    except (ExoidError, np.linalg.LinAlgError):  # a covariance without a metric
        return
    apart = max(apart, distance)
    away = f"{apart:.3g} standard deviations away"
    message = f"no leg can have these parameters ({'; '.join(reasons)}): the nearest that can are {away}"
    remedy = "look for a wrong sign, unit, length, payload, contact or column, or for missing rotors and springs"
    # but they make no mass negative: of a machine on a floating base, or of all links behind a prismatic joint
    K, of_masses = leg.reduction.collect, np.arange(leg.reduction.collect.shape[1]) % 10 == 0
    masses = (np.abs(K[:, ~of_masses]) < 1e-9).all(axis=1) & (K[:, of_masses] > -1e-9).all(axis=1)
    severity = SEVERITIES[int(not (bodies < -IMPOSSIBLE * np.sqrt(np.diag(errors)))[masses].any())]
    yield Finding("impossible-leg", "", apart, "1", severity, message, remedy, parameters=tuple(leg.parameter_names))


def never_negative(model: TorqueModel) -> NDArray[np.bool_]:
    """Find the parameters that cannot be negative: friction, rotor inertia, J of planar segments and the total mass."""
    rigid = set(model.leg.parameter_names) if model.leg.limbs else set()
    return np.asarray(model.nonnegative | np.array([name in rigid and name[0] in "JM" for name in model.names]))


def with_negative(estimate: Estimate) -> Estimate:
    """Name friction, rotors and J of segments that are negative by far more than their error, for no known cause."""
    of, values = estimate.model, estimate.values
    below = never_negative(of) & (values < 0.0) & (values < -IMPOSSIBLE * estimate.std)
    names = tuple(np.array(of.names)[below & ~np.isin(of.names, list(estimate.doubtful))].tolist())
    if not names:
        return estimate
    message = f"{', '.join(names)} negative beyond error, which nature does not allow"
    remedy = "look for a term that is missing (exoid select), a wrong sign, or the torque of another joint"
    found = Finding("negative-parameter", "", float(len(names)), "1", "warning", message, remedy, None, names)
    return replace(estimate, findings=ordered((*estimate.findings, found)))


def _segments(leg: Leg, values: FloatArray) -> FloatArray:
    """Values of (X, Y, J) of each segment among all, (n, 3)."""
    rigid = len(leg.parameter_names)
    return values[rigid - 3 * len(leg.joint_names) : rigid].reshape(-1, 3)


def turned_segment(checked: CheckedFit, least: float) -> Iterator[Finding]:
    """Find mass moments of segments that are turned from the URDF's by more than so much [rad]; only of planar legs."""
    # A wrong zero turns (X, Y) of all segments behind its joint alike, and a tilt of the base those of all. Only
    # coupling to others shows more of it, and of the last joint nothing does.
    leg = checked.fitted.model.leg
    for limb in leg.limbs:
        drawn, found = (_segments(leg, x)[limb.joints, :2] for x in (leg.parameters, checked.fitted.values))
        size, names = np.hypot(*found.T), (leg.joint_names[limb.joints], leg.link_names[limb.joints])
        if (np.hypot(*drawn.T) == 0.0).any() or (size == 0.0).any():
            continue
        cross, dot = found[:, 0] * drawn[:, 1] - found[:, 1] * drawn[:, 0], (found * drawn).sum(axis=1)
        turns = np.arctan2(cross, dot)  # about one axis
        errors = _segments(leg, np.sqrt(np.diag(checked.fitted.covariance)))[limb.joints, :2].max(axis=1) / size
        weights, candidates = errors.clip(1e-3, 1e3) ** -2.0, []
        for first in range(len(turns)):
            angle, error = float(np.average(turns[first:], weights=weights[first:])), float(errors[first:].min())
            apart = np.abs(turns - np.where(np.arange(len(turns)) < first, 0.0, angle))
            if (apart <= 0.25 * abs(angle) + 2.0 * np.hypot(errors, error))[first:].all():
                candidates.append((float(weights @ apart**2), first, angle, error))
        _, first, angle, error = min(candidates)  # the joint behind which all are turned alike, and none before it
        known = np.flatnonzero(errors < 0.25 * abs(angle))  # each of them is turned: URDFs of CAD are off by 1.7°
        if abs(angle) <= 4.0 * error or (np.abs(turns) - errors)[known[known >= first]].min() <= least:
            continue
        joint, behind = names[0][first], " and ".join(names[1][first:])
        kind, value = "angle-offset", float(limb.chain.signs[first]) * angle
        reason, remedy = f"the zero of {joint} is off by that", "check the zero of the encoder at a measured pose"
        if first == 0 and len(turns) > 1:
            kind, joint, value, remedy = "gravity-direction", "", -value, f"level the base, and {remedy}"
            reason = "the base is tilted by that, or the zero of the first angle is wrong"
        message = (
            f"mass moments of {behind} lie {abs(np.degrees(angle)):.3g}° from their directions in the URDF: "
            f"{reason}, or the URDF is wrong; the log alone cannot tell"
        )
        yield Finding(kind, joint, value, "rad", "info", message, remedy, (value - 2.0 * error, value + 2.0 * error))


def large_residuals(checked: CheckedFit, left: FloatArray, *, impossible: bool) -> Iterator[Finding]:
    """Find joints whose torque the model does not explain, nor, by the RMS residuals left, faults that were found."""
    model, wrong = checked.fitted.model, 0.5 if impossible else 0.9
    for j, (joint, nrmse) in enumerate(zip(model.leg.joint_names, checked.nrmse.tolist(), strict=True)):
        # Friction of another form leaves less than 15 %, noise of a sensor is less persistent, and a push is short:
        # numbers of other faults would explain it, too.
        lasting, when = checked.persistence[j] > 0.5 and left[j] > 0.15 * checked.spread[j], _when(checked, j)
        if nrmse <= (0.15 if lasting or when else 0.5):
            continue
        remedy = (
            "check whether this channel is the torque of this joint, and for contacts, straps and cables; if the torso "
            "moved, record its motion: Recording(base=BaseMotion.from_imu(...)); else record larger or faster motions"
        )
        message, severity = f"the model leaves {nrmse:.0%} of the torque unexplained", SEVERITIES[int(nrmse <= wrong)]
        message, names = message + when, tuple(np.array(model.names)[model.acting[j]].tolist())
        yield Finding("large-residual", joint, nrmse, "1", severity, message, remedy, None, names)


def unbalanced(model: TorqueModel, by_row: Iterable[Iterable[RFactor]], values: FloatArray) -> Iterator[Finding]:
    """Find passive joints whose torque is not zero: where it has to be, parameters become too small."""
    for joint, r_factors in zip(model.row_names, by_row, strict=True):
        R = np.vstack([each.R for each in r_factors])
        left, parts = np.linalg.norm(R[:, :-1] @ values), np.linalg.norm(R[:, :-1] * values)
        if R[:, -1].any() or left <= 0.05 * parts:  # healthy machines leave 0.043, seeds below 160
            continue
        share = float(left / parts)
        message = f"gravity, inertia and friction of {joint}, which is passive, cancel but for {share:.0%}"
        remedy, severity = "add stiffness for a spring or a cable, or give unmeasured=", SEVERITIES[int(share < 0.1)]
        names = tuple(np.array(model.names)[R[:, : len(model.names)].any(axis=0)].tolist())
        yield Finding("large-residual", joint, share, "1", severity, message, remedy, None, names)


def _when(checked: CheckedFit, joint: int) -> str:
    """When over half of the squared residual of a joint is, if in a tenth of all time: a push, an end stop, a brake."""
    evidence, power = checked.evidence, [residual[:, joint] ** 2 for residual in checked.residuals]
    width, whole = 0.1 * sum(float(np.ptp(part.time)) for part in evidence.parts), sum(x.sum() for x in power)
    for part, source, squares in zip(evidence.parts, evidence.sources, power, strict=True):
        before, stop = np.cumsum(np.append(0.0, squares)), np.searchsorted(part.time, part.time + width)
        inside = before[stop] - before[:-1]
        if inside.max() > 0.5 * whole:
            there = slice(int(inside.argmax()), int(stop[inside.argmax()]))
            middle = float(np.average(part.time[there], weights=squares[there]))
            return f", over half of that around {middle:.4g} s{f' of {source}' if source else ''}"
    return ""
