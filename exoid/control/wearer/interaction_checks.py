"""Findings of an interaction: what else than a wearer may look like one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import EstimateData
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import scaled_inverse

from .action import Evidence, JointAction


def constant_torques(
    estimate: EstimateData, evidence: Evidence, actions: Sequence[JointAction], source: str
) -> Iterator[Finding]:
    """Find torques that are constant: a zero of a sensor that moved looks like a wearer who pushes evenly."""
    for joint, mean, power, action in zip(estimate.joint_names, evidence.mean, evidence.power, actions, strict=True):
        if action.steady and (not action.acts or mean**2 > 10.0 * power):
            message = "the torque beside the actuator's is constant, as of a torque sensor whose zero is off"
            remedy = "take the zero of the sensor unworn, or identify with an offset for each recording (own=offset)"
            kind = "constant-interaction"
            yield Finding(kind, joint, float(mean), "N·m", "warning", message, remedy, recording=source)


def body_like(
    estimate: EstimateData, bodies: FloatArray | None, actions: Sequence[JointAction], source: str
) -> Iterator[Finding]:
    """Find an interaction that other bodies on the leg explain, W δ ≈ τ_w: a payload, a limb, or a wrong estimate."""
    if bodies is None or not any(action.acts for action in actions):
        return
    A, b, whole = bodies[:-1, :-1], bodies[:-1, -1], bodies[-1, -1]
    values = estimate.values[: len(b)]
    weight = values @ A @ values
    if whole <= 0.0 or weight <= 0.0:
        return
    change = scaled_inverse(A) @ b
    part, heavier = min(float(b @ change / whole), 1.0), -float(change @ A @ values / weight)
    if part < 0.9:
        return
    share = f"{part:.0%} of the torque is that of bodies on the leg"
    if heavier < -1.0:
        message = f"{share} with a negative mass: the torque of this recording seems to have the other sign"
        remedy = "check the signs of its torques (exoid check)"
    elif heavier < -0.01:
        message = f"{share}: it takes {-heavier:.0%} less torque than the estimate says"
        remedy = "check that the estimate was identified from this leg, unworn, without a payload that is missing now"
    elif heavier > 0.01:
        message = f"{share}: it takes {heavier:.0%} more torque than the estimate says"
        remedy = "state payloads (payloads=, --payload) and check the leg; for a passive limb see exoid compare"
    else:
        message = f"{share}: another leg than the estimate's, or a passive limb"
        remedy = "check that the estimate belongs to this leg; see exoid compare for a passive limb"
    yield Finding("body-like-interaction", "", part, "1", "warning", message, remedy, recording=source)


def rough_estimate(estimate: EstimateData, predicted: FloatArray, source: str) -> Iterator[Finding]:
    """Find joints whose training left over 30 % of the torque unexplained: something may have acted there too."""
    columns = (estimate.joint_names, estimate.residual_rms, predicted.std(axis=0), estimate.trained)
    for joint, rms, size, trained in zip(*columns, strict=True):
        if trained and rms > 0.3 * size > 0.0:
            message = (
                f"residuals of the training ({rms:.3g} N·m) are {rms / size:.0%} of the torque here: a wearer within "
                "them is not noticed, and one may have acted in the training"
            )
            remedy = "identify from recordings without a wearer, and look at the findings of the estimate"
            value = float(rms / size)
            yield Finding("rough-estimate", joint, value, "1", "warning", message, remedy, recording=source)


def too_few_samples(estimate: EstimateData, evidence: Evidence, source: str) -> Iterator[Finding]:
    """Find recordings that are too short for the test."""
    least = float(np.min(np.where(np.isnan(evidence.power), np.inf, evidence.effective)))
    if least < 20.0:
        joint = estimate.joint_names[int(np.argmin(evidence.effective))]
        message = f"only {least:.0f} samples count as independent: a wearer who moves slowly is hardly told from noise"
        yield Finding("short-recording", joint, least, "1", "warning", message, "record longer", recording=source)
