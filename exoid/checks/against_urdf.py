"""Checks against the URDF and physics: the scale of the torque, legs that cannot exist, legs far from their drawing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.findings import Finding
from exoid.lift import check as can_exist
from exoid.torques import TorqueModel

from .score import Evidence

OTHER_UNIT = 3.0
"""A torque that is so many times larger or smaller than the URDF's inertias ask for has another unit."""

MILLI = (300.0, 3000.0)
"""A scale between these looks like N·mm."""

EXPLAINED = 0.4
"""The scaled torque and friction leave at most this part of the torque."""

VISIBLE = 0.1
"""The rigid bodies' torque is to be at least this part of the joint's."""

DRAWS = 60
"""Sets of parameters that are drawn from the estimate's distribution to see whether one can exist."""

TURNED = 0.2
"""A mass moment that points elsewhere by this angle is reported [rad]."""

FAR = 2.0
"""A mass moment or an inertia that is so many times larger or smaller than in the URDF is far from it."""

POOR, HOPELESS = 0.5, 0.9
"""NRMSE of a joint beyond which its residual is large, and beyond which the torque is not explained."""


def torque_scale(model: TorqueModel, evidence: Evidence) -> Iterator[Finding]:
    """Compare the torque of each joint with that of the URDF's inertias, friction left free.

    Args:
        model: Torque model.
        evidence: Rows.

    Yields:
        Findings of kind torque-scale, one for each joint, or one for all.
    """
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


def impossible_leg(model: TorqueModel, values: FloatArray, covariance: FloatArray) -> Iterator[Finding]:
    """Find parameters that no leg can have, by more than their errors; only of planar legs.

    Args:
        model: Torque model.
        values: Parameters, (P,).
        covariance: Their covariance, (P, P).

    Yields:
        One finding, or none.
    """
    leg = model.leg
    if leg.chain is None:
        return
    rigid = len(leg.parameter_names)
    verdict = can_exist(leg, values[:rigid])
    if verdict.physical:
        return
    sizes, vectors = np.linalg.eigh(covariance[:rigid, :rigid])
    root = vectors * np.sqrt(np.maximum(sizes, 0.0))
    draws = np.random.default_rng(0).standard_normal((DRAWS, rigid)) @ root.T
    if any(can_exist(leg, values[:rigid] + 1.5 * draw).physical for draw in draws):
        return
    yield Finding(
        "impossible-leg",
        "",
        1.0,
        "1",
        "warning",
        "no leg can have these parameters: " + "; ".join(verdict.reasons),
        "look for a wrong sign, unit or length; rotor inertia and springs that the model lacks also do this",
        parameters=tuple(leg.parameter_names),
    )


def far_from_urdf(model: TorqueModel, values: FloatArray, std: FloatArray) -> Iterator[Finding]:
    """Find segments whose mass moment or inertia is far from the URDF's, beyond their errors; only of planar legs.

    Args:
        model: Torque model.
        values: Parameters, (P,).
        std: Their standard deviations, (P,).

    Yields:
        One finding for each segment.
    """
    leg = model.leg
    if leg.chain is None:
        return
    count = 3 * len(leg.joint_names)
    urdf, found = leg.parameters[:count].reshape(-1, 3), values[:count].reshape(-1, 3)
    errors = std[:count].reshape(-1, 3)
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
    """Compare the direction of the last segment's mass moment with that of the URDF; only of planar legs.

    A wrong zero of the last angle turns (X, Y) of the last segment and changes nothing else: a log alone does not show
    it.

    Args:
        model: Torque model.
        values: Parameters, (P,).
        std: Their standard deviations, (P,).

    Yields:
        One finding, or none.
    """
    leg = model.leg
    if leg.chain is None:
        return
    last = slice(3 * len(leg.joint_names) - 3, 3 * len(leg.joint_names) - 1)
    (drawn, found), size = (leg.parameters[last], values[last]), float(np.hypot(*leg.parameters[last]))
    if size == 0.0 or not found.any():
        return
    cross, dot = found[0] * drawn[1] - found[1] * drawn[0], float(found @ drawn)
    angle = float(leg.chain.signs[-1] * np.arctan2(cross, dot))
    error = float(std[last].max() / np.hypot(*found))
    if abs(angle) > TURNED and abs(angle) > 4.0 * error:
        yield Finding(
            "angle-offset",
            leg.joint_names[-1],
            angle,
            "rad",
            "info",
            f"the centre of mass of {leg.link_names[-1]} lies in a direction {abs(np.degrees(angle)):.3g}° from the "
            "URDF's: the zero of its joint is off by that, or the URDF is wrong; the log alone cannot tell",
            "check the zero of the encoder against a pose that was measured",
            interval=(angle - 2.0 * error, angle + 2.0 * error),
        )


def large_residuals(model: TorqueModel, nrmse: FloatArray) -> Iterator[Finding]:
    """Find joints whose torque the model does not explain.

    Args:
        model: Torque model.
        nrmse: RMS residual of each joint over the standard deviation of its torque, (n,).

    Yields:
        One finding for each joint.
    """
    for j, joint in enumerate(model.joint_names):
        if nrmse[j] > POOR:
            yield Finding(
                "large-residual",
                joint,
                float(nrmse[j]),
                "1",
                "error" if nrmse[j] > HOPELESS else "warning",
                f"the model leaves {nrmse[j]:.0%} of the torque unexplained",
                "check whether this channel is the torque of this joint, and record larger or faster motions",
                parameters=_acting(model, j),
            )


def nrmse_of(evidence: Evidence, values: FloatArray) -> FloatArray:
    """RMS residual of each joint over the standard deviation of its torque, (n,).

    Args:
        evidence: Rows.
        values: Parameters, (P,).

    Returns:
        NRMSE of each joint; 0 where the torque is constant.
    """
    found = []
    for j in range(evidence.joints):
        W = np.vstack([part.W[part.usable[:, j], j, : evidence.count] for part in evidence.parts])
        tau = np.concatenate([part.tau[part.usable[:, j], j] for part in evidence.parts])
        spread = float(np.std(tau)) if len(tau) else 0.0
        rms = float(np.sqrt(np.mean((tau - W @ values) ** 2))) if len(tau) else 0.0
        found.append(rms / spread if spread > 0.0 else 0.0)
    return np.array(found)


def _scale_finding(joint: str, scale: float, names: Sequence[str]) -> Finding:
    whose = f"the torque of {joint}" if joint else "all torques"
    looks = (
        "as N·mm would be"
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
        "convert the torque to N·m at the joint; if it is right, the URDF's inertias are wrong",
        parameters=tuple(names),
    )


def _acting(model: TorqueModel, joint: int) -> tuple[str, ...]:
    return tuple(name for name, acts in zip(model.names, model.acting[joint], strict=True) if acts)
