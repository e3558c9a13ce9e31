"""Findings of a validation: motion beyond that of the training, and torque that is not predicted or is late."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray
from exoid.regression.rows import for_leg
from exoid.signals import Recording, without_torque_delay

from .data import EstimateData
from .finding import Finding
from .motion_ranges import MotionRanges

BEYOND = 1.3
"""A speed or acceleration so many times larger than in the training is an extrapolation,"""

ANGLE = 0.2
"""and an angle that goes beyond the training's range by this part of the range."""

POOR, USELESS = 0.5, 1.0
"""NRMSE beyond which a prediction is poor, and worse than a constant torque."""

GROWN = 2.0
"""A residual so many times larger than that of the training is large,"""

NEGLIGIBLE = 0.02
"""unless its NRMSE is below this."""

NARROW = 0.85
"""A band of 95 % that contains less than this share is too narrow,"""

SIGNIFICANT = 1e-3
"""where chance would give so small a share with less than this probability."""

LATE = 0.5
"""A torque is late where so large a correlation with its time derivative is left in the residual."""


def as_trained(estimate: EstimateData, recording: Recording) -> Recording:
    """Compute torques by the drives of the training, and shift them by the delays that were taken out there."""
    if estimate.actuators is not None:
        recording = estimate.actuators.torque(recording)
    late = {joint: delay for joint, delay in enumerate(estimate.torque_delays.tolist()) if delay}
    return without_torque_delay(for_leg(estimate.model, recording), late) if late else recording


def shifted_torques(estimate: EstimateData, source: str = "") -> Iterator[Finding]:
    """Say by how much torques are shifted."""
    for joint, delay in zip(estimate.joint_names, estimate.torque_delays.tolist(), strict=True):
        if delay:
            yield Finding(
                "torque-delay",
                joint,
                delay,
                "s",
                "info",
                f"the torque of {joint} was shifted by {1e3 * delay:.3g} ms, the delay of the training",
                "correct the time stamps of both logs, and identify without delay",
                recording=source,
            )


def extrapolations(estimate: EstimateData, ranges: MotionRanges, source: str = "") -> Iterator[Finding]:
    """Find joints that move further, faster or more abruptly than in the training."""
    trained = estimate.evidence.ranges
    if trained is None:
        return
    span = np.maximum(trained.highest - trained.lowest, 1e-9)
    outside = np.maximum(trained.lowest - ranges.lowest, ranges.highest - trained.highest) / span
    for k, joint in enumerate(estimate.joint_names):
        sizes = (
            ("angle", float(1.0 + outside[k]), 1.0 + ANGLE),
            ("speed", float(ranges.speed[k] / max(trained.speed[k], 1e-9)), BEYOND),
            ("acceleration", float(ranges.acceleration[k] / max(trained.acceleration[k], 1e-9)), BEYOND),
        )
        for quantity, ratio, limit in sizes:
            if ratio > limit:
                yield Finding(
                    "extrapolation",
                    joint,
                    ratio,
                    "1",
                    "warning",
                    f"the {quantity} goes to {ratio:.3g} times that of the training: the prediction and its band are "
                    "not supported by data there",
                    "identify from a recording that reaches as far",
                    recording=source,
                )


def unmeasured_torques(estimate: EstimateData, measured: BoolArray, source: str = "") -> Iterator[Finding]:
    """Say which joints cannot be validated, and which are predicted without their friction."""
    for joint, trained, there in zip(estimate.joint_names, estimate.trained, measured, strict=True):
        if trained and there:
            continue
        message, remedy = (
            (f"the torque of {joint} was not measured in the training: friction is not predicted", "identify from it")
            if there
            else (f"the torque of {joint} was not measured: its prediction is not compared", "record it")
        )
        yield Finding("unmeasured-torque", joint, 1.0, "1", "info", message, remedy, recording=source)


def poor_predictions(
    estimate: EstimateData,
    nrmse: FloatArray,
    growth: FloatArray,
    source: str = "",
    *,
    passive: BoolArray | None = None,
) -> Iterator[Finding]:
    """Find joints whose torque is predicted badly: by itself, or in comparison with the training."""
    of_passive = np.zeros(len(nrmse), dtype=np.bool_) if passive is None else passive
    for joint, error, grown, is_passive in zip(estimate.joint_names, nrmse, growth, of_passive, strict=True):
        if not np.isfinite(error):
            if grown > GROWN and is_passive:
                yield Finding(
                    "large-residual",
                    joint,
                    float(grown),
                    "1",
                    "warning",
                    f"the joint is passive, and the predicted torque is {grown:.3g} times further from zero than in "
                    "the training",
                    "check whether the joint is really passive, and whether the leg has changed",
                    recording=source,
                )
            elif grown > GROWN:
                yield Finding(
                    "large-residual",
                    joint,
                    float(grown),
                    "1",
                    "error",
                    f"the measured torque never changes, and the residual is {grown:.3g} times that of the training",
                    "connect its torque channel, or map the right column",
                    recording=source,
                )
        elif error > POOR:
            worse = "; a constant torque would predict it better" if error > USELESS else ""
            yield Finding(
                "large-residual",
                joint,
                float(error),
                "1",
                "error" if error > USELESS else "warning",
                f"the estimate leaves {error:.0%} of the torque unexplained{worse}",
                "check signs, units and joints of this recording, and whether the leg has changed (exoid check)",
                recording=source,
            )
        elif grown > GROWN and error > NEGLIGIBLE:
            yield Finding(
                "large-residual",
                joint,
                float(grown),
                "1",
                "warning",
                f"the residual is {grown:.3g} times that of the training",
                "identify from motions like this one, or compare terms of friction (exoid select)",
                recording=source,
            )


def narrow_bands(estimate: EstimateData, coverage: FloatArray, samples: float, source: str = "") -> Iterator[Finding]:
    """Find joints whose torque leaves its 95 % band too often."""
    # The share is tested by the binomial distribution of effective samples: decimated to the pace of independent noise,
    # times the share of effective samples in the training.
    for k, (joint, share) in enumerate(zip(estimate.joint_names, coverage, strict=True)):
        count = max(1, round(samples * effective_share(estimate, k)))
        inside = np.ceil(share * count)
        if share < NARROW and scipy.stats.binom.cdf(inside, count, 0.95) < SIGNIFICANT:
            yield Finding(
                "narrow-band",
                joint,
                float(share),
                "1",
                "warning",
                f"only {share:.0%} of the torque is inside the 95 % band: the model errs by more than in the training",
                "identify from motions like this one, or check whether the leg has changed",
                recording=source,
            )


def effective_share(estimate: EstimateData, joint: int) -> float:
    """Independent samples of the residual over those of white noise, in the training."""
    if not estimate.noise:
        return 1.0
    noise = estimate.noise[joint]
    return min(1.0, noise.effective_samples / max(noise.samples, 1))


def late_torques(
    joints: Sequence[str],
    time: FloatArray,
    predicted: FloatArray,
    residual: FloatArray,
    coverage: FloatArray,
    source: str = "",
) -> Iterator[Finding]:
    """Find joints whose torque is late: τ(t) ≈ τ̂(t − δ) leaves the residual −δ dτ̂/dt."""
    # Joints whose torque stays inside its band are left out: errors of the model suffice to explain their residuals.
    if len(time) < 3:
        return
    rate = np.gradient(predicted, time, axis=0)
    for joint, torque, slope, error, share in zip(joints, predicted.T, rate.T, residual.T, coverage, strict=True):
        product, power = float(slope @ error), float(slope @ slope)
        size = np.sqrt(power * float(error @ error))
        matters = float(error.std()) > NEGLIGIBLE * float((error + torque).std())
        if share < NARROW and matters and abs(product) > LATE * size > 0.0:
            delay = -product / power
            yield Finding(
                "torque-delay",
                joint,
                delay,
                "s",
                "warning",
                f"the torque comes {1e3 * abs(delay):.3g} ms {'after' if delay > 0.0 else 'before'} the predicted one",
                "correct the time stamps of this recording (exoid check)",
                recording=source,
            )
