"""Findings of an interaction: what else than a wearer may look like one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import EstimateData
from exoid.estimate.finding import Finding

from .action import Evidence, JointAction
from .evaluation import BodyFit

BODIES = 0.9
"""Share of a torque beyond which a change of the leg's bodies explains it."""

HEAVIER = 0.01
"""Smallest change of the leg's weight that is called one."""

ROUGH = 0.3
"""Residuals of the training that are so large a part of the torque are no noise."""

FEW = 20.0
"""Fewest independent samples for which the test means something."""

DOMINANT = 10.0
"""A mean square so many times the variance makes a torque constant."""


def constant_torques(
    estimate: EstimateData, evidence: Evidence, actions: Sequence[JointAction], source: str = ""
) -> Iterator[Finding]:
    """Find torques that are constant: a zero of a sensor that moved looks like a wearer who pushes evenly."""
    for joint, mean, power, action in zip(estimate.joint_names, evidence.mean, evidence.power, actions, strict=True):
        if action.steady and (not action.acts or mean**2 > DOMINANT * power):
            yield Finding(
                "constant-interaction",
                joint,
                float(mean),
                "N·m",
                "warning",
                "the torque beside the actuator's is constant, as of a torque sensor whose zero is off",
                "take the zero of the sensor unworn, or identify with an offset for each recording (own=offset)",
                recording=source,
            )


def body_like(
    estimate: EstimateData, bodies: BodyFit | None, actions: Sequence[JointAction], source: str = ""
) -> Iterator[Finding]:
    """Find an interaction that other bodies on the leg explain: a payload, a passive limb, or a wrong estimate."""
    if bodies is None or bodies.share < BODIES or not any(action.acts for action in actions):
        return
    share, weight = f"{bodies.share:.0%} of the torque is that of bodies on the leg", bodies.weight
    if weight > 1.0:
        message = f"{share} with a negative mass: the torque of this recording seems to have the other sign"
        remedy = "check the signs of its torques (exoid check)"
    elif weight > HEAVIER:
        message = f"{share}: it takes {weight:.0%} less torque than the estimate says"
        remedy = "check that the estimate was identified from this leg, unworn, without a payload that is missing now"
    elif weight < -HEAVIER:
        message = f"{share}: it takes {-weight:.0%} more torque than the estimate says"
        remedy = "state payloads (payloads=, --payload) and check the leg; for a passive limb see exoid compare"
    else:
        message = f"{share}: another leg than the estimate's, or a passive limb"
        remedy = "check that the estimate belongs to this leg; see exoid compare for a passive limb"
    yield Finding("body-like-interaction", "", bodies.share, "1", "warning", message, remedy, recording=source)


def rough_estimate(estimate: EstimateData, predicted: FloatArray, source: str = "") -> Iterator[Finding]:
    """Find joints whose training left much torque unexplained: something may have acted there too."""
    spread = predicted.std(axis=0)
    for joint, rms, size, trained in zip(
        estimate.joint_names, estimate.residual_rms, spread, estimate.trained, strict=True
    ):
        if trained and rms > ROUGH * size > 0.0:
            yield Finding(
                "rough-estimate",
                joint,
                float(rms / size),
                "1",
                "warning",
                f"residuals of the training ({rms:.3g} N·m) are {rms / size:.0%} of the torque here: a wearer within "
                "them is not noticed, and one may have acted in the training",
                "identify from recordings without a wearer, and look at the findings of the estimate",
                recording=source,
            )


def too_few_samples(estimate: EstimateData, evidence: Evidence, source: str = "") -> Iterator[Finding]:
    """Find recordings that are too short for the test."""
    least = float(np.min(np.where(np.isnan(evidence.power), np.inf, evidence.effective)))
    if least < FEW:
        yield Finding(
            "short-recording",
            estimate.joint_names[int(np.argmin(evidence.effective))],
            least,
            "1",
            "warning",
            f"only {least:.0f} samples count as independent: a wearer who moves slowly is hardly told from noise",
            "record longer",
            recording=source,
        )


def lower_cutoffs(
    joints: Sequence[str], cutoffs: FloatArray, lost: FloatArray, own: float | None, source: str = ""
) -> Iterator[Finding]:
    """Say which torques are low-passed below the cut-off of the estimate, as noise is larger beyond."""
    for joint, cutoff, rms in zip(joints, cutoffs.tolist(), lost.tolist(), strict=True):
        if own is not None and cutoff < own:
            yield Finding(
                "lower-cutoff",
                joint,
                cutoff,
                "Hz",
                "info",
                f"the torque is low-passed at {cutoff:.3g} Hz, not {own:.3g} Hz: noise is larger than the torque "
                f"beyond, of about {rms:.2g} N·m RMS",
                "pass no cut-off for all that the estimate's filter passes",
                recording=source,
            )
