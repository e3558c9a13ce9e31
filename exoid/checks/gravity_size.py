"""Size of gravity in the readings of an accelerometer: a base that walks in place is not accelerated on average."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.findings import Finding
from exoid.regression.rows import for_leg
from exoid.signals import BaseMotion, Poses, Recording
from exoid.torques import TorqueModel

GRAVITY = 9.81
"""Gravity of the models [m/s²]."""

NOTICEABLE = 0.05
"""Error of the mean specific force that counts [m/s²]: it moves mass moments by 0.5 %."""

GAINED = 1.0
"""Velocity that a base may gain during a recording [m/s]."""

SLOWEST = 0.2
"""Turns slower than this [Hz] count as drift of the gyroscope."""


def gravity_size_findings(model: TorqueModel, data: Sequence[Recording | Poses]) -> Iterator[Finding]:
    """Compare the mean specific force of a base with gravity.

    The mean of R f over a recording is −g, as a base that does not fly away has no mean acceleration. Where it turns to
    and fro by small angles θ, ‖mean f‖ = g (1 − mean θ²/2). A bias along the vertical scales all gravity torques, which
    no residual shows.

    Args:
        model: Torque model.
        data: Recordings and poses.

    Yields:
        A warning for each recording whose accelerometer is off; none where a pose was measured, or links rest.
    """
    for one in data:
        if isinstance(one, Poses) or one.base is None or one.base.pose is not None or one.contacts:
            continue
        recording = for_leg(model, one)
        assert recording.base is not None
        size = float(np.linalg.norm(recording.base.specific_force.mean(axis=0)))
        expected = GRAVITY * (1.0 - 0.5 * _mean_square_turn(recording.base, recording.sample_rate))
        error = size - expected
        limit = NOTICEABLE + GAINED / recording.duration
        if abs(error) > limit:
            yield Finding(
                "gravity-size",
                "",
                error,
                "m/s²",
                "warning",
                f"the accelerometer of the base reads {size:.4g} m/s² on average and {expected:.4g} were expected: it "
                f"is off along the vertical, which changes mass moments by {100.0 * error / GRAVITY:.2g} %",
                "calibrate it (rest it on each side), or record when a foot is flat on the ground (contacts=), which "
                "finds its bias",
                parameters=model.leg.parameter_names,
                recording=one.source.name if one.source else "",
            )


def _mean_square_turn(base: BaseMotion, rate: float) -> float:
    """Mean square of the angles by which a base turns to and fro about horizontal axes [rad²]."""
    omega = base.angular_velocity
    vertical = base.specific_force.mean(axis=0)
    vertical = vertical / np.linalg.norm(vertical)
    across = omega - np.outer(omega @ vertical, vertical)
    angles: FloatArray = np.cumsum(across - across.mean(axis=0), axis=0) / rate
    if 0.2 * rate > SLOWEST and len(angles) > 30:
        filters = scipy.signal.butter(2, SLOWEST, "highpass", fs=rate, output="sos")
        angles = scipy.signal.sosfiltfilt(filters, angles, axis=0)
    return float(np.mean(np.sum(angles**2, axis=1)))
