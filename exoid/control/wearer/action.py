"""Test whether anything acts on a joint beyond its actuator, and findings on what else than a wearer it may be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.estimate import EstimateData
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import scaled_inverse
from exoid.torques.position_units import position_units

from .evaluation import Evaluation

LEVEL = 0.01
"""Largest probability that a recording without a wearer is called worn."""

ALLOWANCE = 1.5
"""Residuals of an unworn leg may be so many times larger than in the training: friction changes from day to day.

Logs of legs that are not worn reach 1.1 (real ones) and 1.3 (friction of another form at twice the speed of the
training, ``scripts/study_interaction.py --unworn``)."""

LIKE = 0.9
"""Share of a torque that bodies or a sensor have to explain to be named."""


class Evidence(NamedTuple):
    """What the residuals of one recording say of each joint, (n,) each."""

    power: FloatArray  # mean square of the torque about its mean [N²·m²]; not a number where it was not measured
    mean: FloatArray  # mean of the torque [N·m]
    noise: FloatArray  # variance that the noise of the training gives it [N²·m²]
    systematic: FloatArray  # mean variance by errors of the parameters and of the form of friction [N²·m²]
    effective: FloatArray  # independent samples that say as much on the power of the noise
    trained: FloatArray  # independent samples behind the variance of the noise


class JointAction(NamedTuple):
    """Result of the test of one joint.

    Attributes:
        p_value: Largest probability of so large a torque where nothing acts; not a number where that was not tested.
        acts: Whether something acts, at the level of the test.
        least: Smallest rms of a torque about its mean that the test would notice [N·m].
        steady: Whether the mean of the torque is beyond its error.
    """

    p_value: float
    acts: bool
    least: float
    steady: bool


def judge(evidence: Evidence, level: float = LEVEL) -> tuple[JointAction, ...]:
    """Test each joint of a recording."""
    # Where nothing acts, the torque about its mean has the power E = σ² + s², noise and systematic error. The noise is
    # that of the training, with N independent samples here and M there. The systematic error has few degrees of
    # freedom: it counts as one. By Satterthwaite the power over A² E then follows F with
    # ν = E² / (σ⁴/N + s⁴) and M degrees of freedom, or less: A is `ALLOWANCE`. All joints together are wrong with
    # the probability `level` at most (Bonferroni).
    #
    # The mean is left out, as a sensor's zero that moved looks like a wearer who pushes evenly.
    tested = ~np.isnan(evidence.power) & (evidence.noise > 0.0)
    E = np.where(tested, evidence.noise + evidence.systematic, 1.0)
    count, behind = np.maximum(evidence.effective, 1.0), np.maximum(evidence.trained, 1.0)
    spread = evidence.noise**2 / count + evidence.systematic**2
    dof = np.maximum(np.divide(E**2, spread, out=np.ones_like(E), where=tested & (spread > 0.0)), 1.0)
    share = level / max(1, int(tested.sum()))
    allowed = ALLOWANCE**2 * E
    p_values = np.where(tested, scipy.stats.f.sf(evidence.power / allowed, dof, behind), np.nan)
    least = np.sqrt(np.maximum(allowed * scipy.stats.f.isf(share, dof, behind) - E, 0.0))
    of_mean = 2.0 * evidence.noise / count + evidence.systematic  # 2: correlation counts more for a mean than a power
    beyond = scipy.stats.t.isf(0.5 * share, np.minimum(count, behind)) * ALLOWANCE * np.sqrt(of_mean)
    steady = tested & (np.abs(np.nan_to_num(evidence.mean)) > beyond)
    columns = (p_values, tested & (p_values < share), np.where(tested, least, np.nan), steady)
    return tuple(JointAction(*each) for each in zip(*(x.tolist() for x in columns), strict=True))


def constant_torques(estimate: EstimateData, evidence: Evidence, actions: Sequence[JointAction]) -> Iterator[Finding]:
    """Find torques that are constant: a zero of a sensor that moved looks like a wearer who pushes evenly."""
    columns = (evidence.mean, evidence.power, actions, position_units(estimate.model.leg))
    for joint, mean, power, action, unit in zip(estimate.joint_names, *columns, strict=True):
        if action.steady and (not action.acts or mean**2 > 10.0 * power):
            message = (
                "the torque beside the actuator's is constant, as of a torque sensor or an angle whose zero is off"
            )
            remedy = "take the zero of the sensor unworn, or identify with an offset for each recording (own=offset)"
            yield Finding("constant-interaction", joint, float(mean), unit.torque, "warning", message, remedy)


def explanations(estimate: EstimateData, found: Evaluation, actions: Sequence[JointAction]) -> list[Finding]:
    """Find what explains an interaction: bodies, or sensors and friction if they do so better at all joints."""
    acting = [joint for joint, action in zip(estimate.joint_names, actions, strict=True) if action.acts]
    bodies = list(_body_like(estimate, found.bodies)) if acting else []
    others = list(_sensor_like(estimate, found, acting))
    if not bodies or len(others) < len(acting):
        return bodies or others
    weight = (found.torque.var(axis=0) / np.maximum(found.noise, 1e-300))[np.isin(estimate.joint_names, acting)]
    return others if np.average([one.value for one in others], weights=weight) > bodies[0].value else bodies


def _body_like(estimate: EstimateData, bodies: FloatArray | None) -> Iterator[Finding]:
    """Find an interaction that other bodies on the leg explain, W δ ≈ τ_w: a payload, a limb, or a wrong estimate."""
    if bodies is None:
        return
    A, b, whole = bodies[:-1, :-1], bodies[:-1, -1], bodies[-1, -1]
    values = estimate.values[: len(b)]
    weight = values @ A @ values
    if whole <= 0.0 or weight <= 0.0:
        return
    change = scaled_inverse(A) @ b
    part, heavier = min(float(b @ change / whole), 1.0), -float(change @ A @ values / weight)
    if part < LIKE:
        return
    share = f"{part:.0%} of the torque is that of bodies on the leg"
    if heavier < -0.01:
        message = f"{share}: it takes {-heavier:.0%} less torque than the estimate says"
        remedy = "check that the estimate was identified from this leg, unworn, without a payload that is missing now"
    elif heavier > 0.01:
        message = f"{share}: it takes {heavier:.0%} more torque than the estimate says"
        remedy = "state payloads (payloads=, --payload) and check the leg; for a passive limb see exoid compare"
    else:
        message = f"{share}: another leg than the estimate's, or a passive limb"
        remedy = "check that the estimate belongs to this leg; see exoid compare for a passive limb"
    yield Finding("body-like-interaction", "", part, "1", "warning", message, remedy)


def _sensor_like(estimate: EstimateData, found: Evaluation, acting: Sequence[str]) -> Iterator[Finding]:
    """Find an interaction τ̂ − τ of a sensor that reads τ = g τ̂(t) or τ̂(t − δ) beside its zero, or of friction g F̂."""
    # half way between both torques, τ̂(t) − τ̂(t − δ) ≈ δ τ̂'(t − δ/2) holds to the second order
    slope = np.gradient(found.predicted - 0.5 * found.torque, found.time, axis=0)
    sensors = "check sign, scale and time stamps of the torque in a recording without a wearer (exoid check)"
    friction = "identify again, unworn and as warm as here; a wearer who only brakes or drives looks the same"
    forms = (
        ("sensor", "a sensor that reads {0:.3g} times the torque", sensors),
        ("sensor", "a sensor that is {1:.3g} ms late", sensors),
        ("friction", "friction that is {0:.3g} times the estimate's", friction),
    )
    for joint in acting:
        k = estimate.joint_names.index(joint)
        felt = found.torque[:, k] - found.torque[:, k].mean()
        rows = np.array([each[:, k] - each[:, k].mean() for each in (found.predicted, slope, found.friction)])
        ratios = rows @ felt / np.maximum((rows**2).sum(axis=1), 1e-300)
        shares = ratios * (rows @ felt) / (felt @ felt)
        best = int(shares.argmax())
        kind, what, remedy = forms[best]
        if (share := float(shares[best])) > LIKE:
            message = f"{share:.0%} of the torque is as of {what.format(1.0 - ratios[best], 1e3 * ratios[best])}"
            yield Finding(f"{kind}-like-interaction", joint, share, "1", "warning", message, remedy)


def rough_estimate(estimate: EstimateData, predicted: FloatArray) -> Iterator[Finding]:
    """Find errors of the training, and joints of which it left over 30 % of the torque unexplained."""
    wrong = sorted({finding.kind for finding in estimate.findings if finding.severity == "error"})
    if wrong:
        message = f"the estimate has errors ({', '.join(wrong)}): that nothing acts cannot be told from it"
        remedy = "mend the recordings of the training, and identify again"
        yield Finding("rough-estimate", "", 1.0, "1", "error", message, remedy)
    columns = (estimate.residual_rms, predicted.std(axis=0), estimate.trained, position_units(estimate.model.leg))
    for joint, rms, size, trained, unit in zip(estimate.joint_names, *columns, strict=True):
        if trained and rms > 0.3 * size > 1e-6 * rms:  # no torque that only rounding changes
            message = (
                f"residuals of the training ({rms:.3g} {unit.torque}) are {rms / size:.0%} of the torque here: a "
                "wearer within them is not noticed, and one may have acted in the training"
            )
            remedy = "identify from recordings without a wearer, and look at the findings of the estimate"
            yield Finding("rough-estimate", joint, float(rms / size), "1", "warning", message, remedy)


def too_few_samples(estimate: EstimateData, evidence: Evidence) -> Iterator[Finding]:
    """Find recordings that are too short for the test."""
    tested = np.where(np.isnan(evidence.power), np.inf, evidence.effective)
    least, joint = float(tested.min()), estimate.joint_names[int(np.argmin(tested))]
    if least < 20.0:
        message = f"only {least:.0f} samples count as independent: a wearer who moves slowly is hardly told from noise"
        yield Finding("short-recording", joint, least, "1", "warning", message, "record longer")
