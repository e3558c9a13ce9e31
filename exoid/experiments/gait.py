"""A healthy stride, which document 2's swing leg follows (its Fig. 6)."""

from __future__ import annotations

import numpy as np

from .references import Harmonics

MEAN_DEG = np.array([7.4377, 22.5942])
"""a0 of hip and knee flexion [deg]."""

COSINE_DEG = np.array(
    [
        [10.6017, -3.8939, -0.8879, -0.1671, -0.6595, 0.1313],
        [-8.0762, -15.0416, 0.2818, -1.0307, -0.2604, 0.3631],
    ]
)
"""a1 … a6 of hip and knee [deg]."""

SINE_DEG = np.array(
    [
        [-6.8851, -2.0996, 1.9815, -0.1354, -0.2903, -0.0072],
        [-22.1204, 10.7759, 4.1605, 0.7560, 0.4598, 0.0265],
    ]
)
"""b1 … b6 of hip and knee [deg]; six harmonics fit a published stride to 0.2° rms."""


def healthy_gait(scale: float = 1.2, period: float = 10.0) -> Harmonics:
    """Hip and knee flexion of a stride, θ = a0 + Σ scale (a_k cos 2πkp + b_k sin 2πkp), p = t/period from heel contact.

    Document 2 enlarges the amplitudes by a factor it does not print and takes 10 s for a stride.

    Args:
        scale: Of the amplitudes about the mean.
        period: Of the stride [s].

    Returns:
        The motion of one CUHK-EXO leg; both angles positive in flexion.
    """
    size = scale * np.deg2rad(np.hypot(COSINE_DEG, SINE_DEG))
    frequency = 2.0 * np.pi / period * np.arange(1.0, 7.0)[:, None, None]
    phase = np.arctan2(COSINE_DEG, SINE_DEG)  # a cos x + b sin x = c sin(x + phase)
    return Harmonics(np.deg2rad(MEAN_DEG)[:, None], size.T[..., None], frequency, phase.T[..., None])
