"""Findings of a validation: motion beyond that of the training, and torque that is not predicted or is late."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray

from .data import EstimateData
from .evidence import MotionRanges
from .finding import Finding, Severity

BEYOND, ANGLE = 1.3, 0.2  # speeds and accelerations over the training's, and angles beyond its range, in parts of that
POOR, USELESS = 0.5, 1.0  # NRMSE beyond which a prediction is poor, and worse than a constant torque
GROWN, NEGLIGIBLE = 2.0, 0.02  # a residual over the training's is large, unless NRMSE is below the second
NARROW, SIGNIFICANT = 0.85, 1e-3  # share inside a 95 % band that is too narrow, where chance is less probable than this
WIDE = 0.75  # RMS half width of a band, in standard deviations of the torque, that is too wide to mean something
LATE = 0.5  # correlation of the residual with the time derivative of a torque that is late


def extrapolations(estimate: EstimateData, ranges: MotionRanges) -> Iterator[Finding]:
    """Find joints that move further, faster or more abruptly than in the training."""
    trained = estimate.evidence.ranges
    if trained is None:
        return
    span = np.maximum(trained.highest - trained.lowest, 1e-9)
    outside = np.maximum(trained.lowest - ranges.lowest, ranges.highest - trained.highest) / span
    ratios = {
        "angle": (1.0 + outside, 1.0 + ANGLE),
        "speed": (ranges.speed / np.maximum(trained.speed, 1e-9), BEYOND),
        "acceleration": (ranges.acceleration / np.maximum(trained.acceleration, 1e-9), BEYOND),
    }
    remedy = "identify from a recording that reaches as far"
    for k, joint in enumerate(estimate.joint_names):
        for quantity, (ratio, limit) in ratios.items():
            if ratio[k] > limit:
                message = (
                    f"the {quantity} goes to {ratio[k]:.3g} times that of the training: the prediction and its band "
                    "are not supported by data there"
                )
                yield Finding("extrapolation", joint, float(ratio[k]), "1", "warning", message, remedy)


def unmeasured_torques(estimate: EstimateData, measured: BoolArray) -> Iterator[Finding]:
    """Say which joints cannot be validated, and which are predicted without their friction."""
    for joint, trained, there in zip(estimate.joint_names, estimate.trained, measured, strict=True):
        if trained and there:
            continue
        message, remedy = (
            (f"the torque of {joint} was not measured in the training: friction is not predicted", "identify from it")
            if there
            else (f"the torque of {joint} was not measured: its prediction is not compared", "record it")
        )
        yield Finding("unmeasured-torque", joint, 1.0, "1", "info", message, remedy)


def poor_predictions(
    estimate: EstimateData, nrmse: FloatArray, growth: FloatArray, passive: BoolArray
) -> Iterator[Finding]:
    """Find joints whose torque is predicted badly: by itself, or in comparison with the training."""
    for joint, error, grown, is_passive in zip(estimate.joint_names, nrmse, growth, passive, strict=True):
        value: float = float(grown)
        severity: Severity = "warning"
        if not np.isfinite(error) and grown > GROWN and is_passive:
            message = (
                f"the joint is passive, and the predicted torque is {grown:.3g} times further from zero than in the "
                "training"
            )
            remedy = "check whether the joint is really passive, and whether the leg has changed"
        elif not np.isfinite(error) and grown > GROWN:
            severity = "error"
            message = f"the measured torque never changes, and the residual is {grown:.3g} times that of the training"
            remedy = "connect its torque channel, or map the right column"
        elif error > POOR:
            value, severity = float(error), "error" if error > USELESS else "warning"
            worse = "; a constant torque would predict it better" if error > USELESS else ""
            message = f"the estimate leaves {error:.0%} of the leg's torque unexplained{worse}"
            remedy = "check signs, units, joints and force plates, and whether the leg has changed (exoid check)"
        elif grown > GROWN and error > NEGLIGIBLE:
            message = f"the residual is {grown:.3g} times that of the training"
            remedy = "identify from motions like this one, or compare terms of friction (exoid select)"
        else:
            continue
        yield Finding("large-residual", joint, value, "1", severity, message, remedy)


def narrow_bands(estimate: EstimateData, coverage: FloatArray, samples: float) -> Iterator[Finding]:
    """Find joints whose torque leaves its 95 % band too often."""
    # The share is tested by the binomial distribution of effective samples: decimated to the pace of independent noise,
    # times the share of effective samples in the training.
    for k, (joint, share) in enumerate(zip(estimate.joint_names, coverage.tolist(), strict=True)):
        count = max(1, round(samples * effective_share(estimate, k)))
        if share < NARROW and scipy.stats.binom.cdf(np.ceil(share * count), count, 0.95) < SIGNIFICANT:
            message = (
                f"only {share:.0%} of the torque is inside the 95 % band: the model errs by more than in the training"
            )
            remedy = "identify from motions like this one, or check force plates and whether the leg has changed"
            yield Finding("narrow-band", joint, share, "1", "warning", message, remedy)


def wide_bands(estimate: EstimateData, width: FloatArray, coverage: FloatArray) -> Iterator[Finding]:
    """Find joints whose 95 % band is so wide, over the spread of the torque, that a torque inside it means little."""
    for joint, size, share in zip(estimate.joint_names, width.tolist(), coverage.tolist(), strict=True):
        if np.isfinite(size) and size > WIDE:
            message = (
                f"the 95 % band reaches {size:.2g} standard deviations of the torque to each side: that {share:.0%} of "
                "the torque is inside means little"
            )
            remedy = "identify from a larger or longer motion, or with fewer parameters (known=, exoid select)"
            yield Finding("wide-band", joint, size, "1", "warning", message, remedy)


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
            when = "after" if delay > 0.0 else "before"
            message = f"the torque comes {1e3 * abs(delay):.3g} ms {when} the predicted one"
            remedy = "correct the time stamps of this recording, and of force plates (exoid check)"
            yield Finding("torque-delay", joint, delay, "s", "warning", message, remedy)
