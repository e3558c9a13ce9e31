"""A walker's stride without a file: hip and knee of document 2, with an ankle of two harmonics."""

from dataclasses import replace

import numpy as np

from exoid.experiments import Harmonics, healthy_gait


def stride(period: float) -> Harmonics:
    """Flexion of hip, knee and ankle; the ankle turns over 30° as at a free speed."""
    gait = healthy_gait(1.0, period)
    ankle = np.zeros((len(gait.amplitude), 1, 1))
    amplitude, phase = ankle.copy(), ankle.copy()
    amplitude[:2, 0, 0], phase[:2, 0, 0] = np.deg2rad((6.0, 8.0)), (0.3, -2.0)
    return replace(
        gait,
        centre=np.concatenate([gait.centre, [[0.03]]]),
        amplitude=np.concatenate([gait.amplitude, amplitude], axis=1),
        phase=np.concatenate([gait.phase, phase], axis=1),
    )
