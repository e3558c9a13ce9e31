"""Checks against the URDF and physics: the scale of the torque, legs that cannot exist, legs far from their drawing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.leg.leg import Leg
from exoid.leg.lift import check as can_exist
from exoid.leg.lift import lift
from exoid.leg.lift.lift import consistent_within
from exoid.leg.reduction.planar_machine import Limb
from exoid.torques import TorqueModel

from .evidence import Evidence
from .least_sizes import LEAST_SHARE

OTHER_UNIT = 3.0
"""A torque that is so many times larger or smaller than the URDF's inertias ask for has another unit."""

MILLI = (300.0, 3000.0)
"""A scale between these looks like N·mm."""

EXPLAINED = 0.4
"""The scaled torque and friction leave at most this part of the torque."""

VISIBLE = 0.1
"""The rigid bodies' torque is to be at least this part of the joint's."""

IMPOSSIBLE = 4.5
"""Parameters that no leg can have are so many standard deviations from the nearest that one can."""

TURNED = 0.03
"""A mass moment that points elsewhere by this angle is reported [rad]."""

ALIKE = 0.25
"""Segments are turned alike if their angles differ by this part at most, and by their errors."""

FAR = 2.0
"""A mass moment or an inertia that is so many times larger or smaller than in the URDF is far from it."""

NOTICEABLE = 0.15
"""Residual over torque that is found where nothing else is: friction that has another form leaves less."""

PERSISTENT = 0.5
"""Least correlation of such residuals from one row to the next; noise of a sensor has less."""

POOR, HOPELESS = 0.5, 0.9
"""NRMSE of a joint beyond which its residual is large, and beyond which the torque is not explained."""


def torque_scale(model: TorqueModel, evidence: Evidence) -> Iterator[Finding]:
    """Compare the torque of each joint with that of the URDF's inertias, friction left free."""
    urdf, rigid = model.leg.parameters, len(model.leg.parameter_names)
    scales: dict[str, float] = {}
    for j, joint in enumerate(model.joint_names):
        R, terms = evidence.factors[j], np.flatnonzero(model.acting[j, rigid:]) + rigid
        expected, torque = R[:, :rigid] @ urdf, R[:, -1]
        A = np.column_stack([expected, R[:, terms]])
        size = np.linalg.norm(A, axis=0)
        if size[0] == 0.0 or (size[1:] == 0.0).any():
            continue
        x, *_ = np.linalg.lstsq(A / size, torque, rcond=1e-9)
        scale = float(x[0] / size[0])
        share = abs(scale) * size[0] / max(float(np.linalg.norm(torque)), 1e-300)
        left = float(np.linalg.norm(torque - A / size @ x)) / max(float(np.linalg.norm(torque)), 1e-300)
        if share > VISIBLE and left < EXPLAINED:
            scales[joint] = scale
    odd = {joint: scale for joint, scale in scales.items() if abs(np.log(abs(scale))) > np.log(OTHER_UNIT)}
    if len(odd) > 1 and len(odd) == len(scales):
        yield _scale_finding("", float(np.exp(np.mean(np.log(np.abs(list(odd.values())))))), model.names)
        return
    for joint, scale in odd.items():
        yield _scale_finding(joint, abs(scale), model.names)


def impossible_leg(
    model: TorqueModel, evidence: Evidence, values: FloatArray, covariance: FloatArray
) -> Iterator[Finding]:
    """Find parameters that no leg can have, by more than their errors."""
    leg = model.leg
    rigid = len(leg.parameter_names)
    bodies, errors = values[:rigid], covariance[:rigid, :rigid]
    reasons = can_exist(leg, bodies).reasons if leg.chain is not None else ("densities would be negative",)
    if not reasons:
        return
    try:
        apart = _wrong_side(leg, bodies, errors)
        if apart < IMPOSSIBLE and consistent_within(leg, bodies, errors, IMPOSSIBLE):
            return
        nearest = lift(leg, bodies, errors)
        change = evidence.torque_shares(np.arange(rigid), bodies - nearest.values).max()
        if apart < IMPOSSIBLE and change < LEAST_SHARE:
            return
        apart = max(apart, nearest.distance)
    except (ExoidError, np.linalg.LinAlgError):  # a covariance without a metric
        return
    if apart < IMPOSSIBLE:
        return
    yield Finding(
        "impossible-leg",
        "",
        apart,
        "1",
        "warning",
        f"no leg can have these parameters ({'; '.join(reasons)}): the nearest that can are {apart:.3g} standard "
        "deviations away",
        "look for a wrong sign, unit or length; rotor inertia and springs that the model lacks also do this",
        parameters=tuple(leg.parameter_names),
    )


def _wrong_side(leg: Leg, values: FloatArray, covariance: FloatArray) -> float:
    """By how many standard deviations the centre of mass of a segment is on the wrong side of its joint."""
    if not leg.limbs:
        return 0.0
    sizes = [0.0]
    for start in range(len(values) - 3 * len(leg.joint_names), len(values), 3):
        place = slice(start, start + 2)
        direction = leg.parameters[place]
        std = float(np.sqrt(direction @ covariance[place, place] @ direction))
        if std > 0.0:
            sizes.append(-float(direction @ values[place]) / std)
    return max(sizes)


def far_from_urdf(model: TorqueModel, values: FloatArray, std: FloatArray) -> Iterator[Finding]:
    """Find segments whose mass moment or inertia is far from the URDF's, beyond their errors; only of planar legs."""
    leg = model.leg
    if not leg.limbs:
        return
    urdf, found, errors = (_segments(leg, x) for x in (leg.parameters, values, std))
    for k, joint in enumerate(leg.joint_names):
        pairs = (
            ("mass moment", float(np.hypot(*urdf[k, :2])), float(np.hypot(*found[k, :2])), errors[k, :2].max(), "kg·m"),
            ("inertia", float(urdf[k, 2]), float(found[k, 2]), float(errors[k, 2]), "kg·m²"),
        )
        for what, drawn, identified, error, unit in pairs:
            if drawn <= 0.0 or abs(identified - drawn) < 4.0 * error:
                continue
            ratio = identified / drawn
            if 1.0 / FAR < ratio < FAR:
                continue
            yield Finding(
                "far-from-urdf",
                joint,
                ratio,
                "1",
                "info",
                f"the {what} of {leg.link_names[k]} is {identified:.3g} {unit}, {ratio:.3g} times that of the URDF",
                "check the URDF's inertias, what the leg carried, and the unit of the torque",
            )


def turned_segment(model: TorqueModel, values: FloatArray, std: FloatArray) -> Iterator[Finding]:
    """Compare the directions of the segments' mass moments with those of the URDF; only of planar legs."""
    # A wrong zero of the last angle turns (X, Y) of the last segment and changes nothing else: a log alone does
    # not show it. A tilt of the base turns all segments alike, and a small one changes little else.
    for limb in model.leg.limbs:
        yield from _turned_segment(model.leg, limb, values, std)


def _segments(leg: Leg, values: FloatArray) -> FloatArray:
    """Values of (X, Y, J) of each segment among all, (n, 3)."""
    rigid = len(leg.parameter_names)
    return values[rigid - 3 * len(leg.joint_names) : rigid].reshape(-1, 3)


def _turned_segment(leg: Leg, limb: Limb, values: FloatArray, std: FloatArray) -> Iterator[Finding]:
    """Compare the directions of one limb."""
    names, links = leg.joint_names[limb.joints], leg.link_names[limb.joints]
    drawn, found = (_segments(leg, x)[limb.joints, :2] for x in (leg.parameters, values))
    size = np.hypot(*found.T)
    if (np.hypot(*drawn.T) == 0.0).any() or (size == 0.0).any():
        return
    cross, dot = found[:, 0] * drawn[:, 1] - found[:, 1] * drawn[:, 0], (found * drawn).sum(axis=1)
    turns = limb.chain.signs * np.arctan2(cross, dot)
    errors = _segments(leg, std)[limb.joints, :2].max(axis=1) / size
    angle, error = float(turns[-1]), float(errors[-1])
    if abs(angle) <= max(TURNED, 4.0 * error):
        return
    absolute = limb.chain.signs * turns  # about one axis
    alike = np.abs(absolute - absolute[-1]) < ALIKE * abs(angle) + 2.0 * np.hypot(errors, error)
    if len(names) > 1 and alike.all():
        tilt = -float(turns[0])
        yield Finding(
            "gravity-direction",
            "",
            tilt,
            "rad",
            "info",
            f"the centres of mass of all segments lie in directions {abs(np.degrees(angle)):.3g}° from the URDF's: the "
            "base is tilted by that, or the zero of the first angle is wrong, or the URDF; the log alone cannot tell",
            "level the base, and check the zero of the first encoder against a pose that was measured",
            interval=(tilt - 2.0 * error, tilt + 2.0 * error),
        )
        return
    yield Finding(
        "angle-offset",
        names[-1],
        angle,
        "rad",
        "info",
        f"the centre of mass of {links[-1]} lies in a direction {abs(np.degrees(angle)):.3g}° from the "
        "URDF's: the zero of its joint is off by that, or the URDF is wrong; the log alone cannot tell",
        "check the zero of the encoder against a pose that was measured",
        interval=(angle - 2.0 * error, angle + 2.0 * error),
    )


def persistence_of(evidence: Evidence, values: FloatArray) -> FloatArray:
    """Correlation of residuals from one row to the next: near 0 for noise of a sensor, near 1 for a motion."""
    # Behind the filter, rows are about as far apart as the samples that carry independent noise.
    power, product = np.zeros((2, evidence.joints))
    for part, at_rest in zip(evidence.parts, evidence.at_rest, strict=True):
        if not at_rest:
            residual = np.where(part.usable, part.tau - part.W[..., : evidence.count] @ values, 0.0)
            power += np.sum(residual**2, axis=0)
            product += np.sum(residual[1:] * residual[:-1], axis=0)
    return np.asarray(product / np.maximum(power, np.finfo(float).tiny))


def large_residuals(
    model: TorqueModel, nrmse: FloatArray, *, persistence: FloatArray | None = None
) -> Iterator[Finding]:
    """Find joints whose torque the model does not explain."""
    for j, joint in enumerate(model.joint_names):
        persistent = persistence is not None and persistence[j] > PERSISTENT
        if nrmse[j] > (NOTICEABLE if persistent else POOR):
            yield Finding(
                "large-residual",
                joint,
                float(nrmse[j]),
                "1",
                "error" if nrmse[j] > HOPELESS else "warning",
                f"the model leaves {nrmse[j]:.0%} of the torque unexplained",
                "check whether this channel is the torque of this joint, and record larger or faster motions"
                if nrmse[j] > POOR
                else "if the torso moved, record its motion: Recording(base=BaseMotion.from_imu(...)); else check for "
                "contacts, straps and cables",
                parameters=_acting(model, j),
            )


def torque_spread_of(evidence: Evidence) -> FloatArray:
    """Standard deviation of the torque of each joint in the rows of a fit [N·m], (n,); 0 for a joint without rows."""
    torques = (
        np.concatenate([part.tau[part.usable[:, j], j] for part in evidence.parts]) for j in range(evidence.joints)
    )
    return np.array([float(np.std(tau)) if len(tau) else 0.0 for tau in torques])


def nrmse_of(evidence: Evidence, values: FloatArray) -> FloatArray:
    """RMS residual of each joint over the standard deviation of its torque, (n,)."""
    found = []
    for j, spread in enumerate(torque_spread_of(evidence)):
        W = np.vstack([part.W[part.usable[:, j], j, : evidence.count] for part in evidence.parts])
        tau = np.concatenate([part.tau[part.usable[:, j], j] for part in evidence.parts])
        rms = float(np.sqrt(np.mean((tau - W @ values) ** 2))) if len(tau) else 0.0
        found.append(rms / spread if spread > 0.0 else 0.0)
    return np.array(found)


def negative_friction(model: TorqueModel, values: FloatArray, below: NDArray[np.bool_]) -> Iterator[Finding]:
    """Find friction and rotor inertia that are negative."""
    rigid = set(model.leg.parameter_names)
    names = tuple(name for name, is_below in zip(model.names, below, strict=True) if is_below and name not in rigid)
    if names:
        yield Finding(
            "impossible-leg",
            "",
            float(values[model.names.index(names[0])]),
            model.units[model.names.index(names[0])],
            "warning",
            f"{', '.join(names)}: friction or rotor inertia cannot be negative, by more than their errors",
            "a term is missing, a sign is wrong, or the torque is not that of this joint",
            parameters=names,
        )


def _scale_finding(joint: str, scale: float, names: Sequence[str]) -> Finding:
    whose = f"the torque of {joint}" if joint else "all torques"
    looks = (
        "as N·mm would be, or a current in mA times N·m per A"
        if MILLI[0] < scale < MILLI[1]
        else "as the torque of the motor in front of a gear, or a current in amperes, would be"
        if scale < 1.0
        else "as another unit would make it"
    )
    return Finding(
        "torque-scale",
        joint,
        scale,
        "1",
        "error",
        f"{whose} is {scale:.3g} times what the URDF's inertias ask for, {looks}; the log alone cannot tell",
        "convert the torque to N·m at the joint by the unit or the scale of its column (a current: N·m per A, "
        "tau_<joint>=HEADER:SCALE); if it is right, the URDF's inertias are wrong",
        parameters=tuple(names),
    )


def _acting(model: TorqueModel, joint: int) -> tuple[str, ...]:
    return tuple(name for name, acts in zip(model.names, model.acting[joint], strict=True) if acts)
