"""Smooth motions: sums of sines that begin at rest."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

LEAD = 2.0
"""Time in which a machine settles before the log begins [s]."""

RISE = 1.5
"""Time in which a motion grows to its full size [s]."""

KNOTS = 100.0
"""Rate at which motions are planned [Hz]."""

SHARES = np.array([0.37, 0.71, 1.0, 1.63])
"""Frequencies of the parts of a motion, over the main one."""

SIZES = np.array([0.5, 0.45, 0.4, 0.15])
"""Sizes of the parts of a motion, over its amplitude."""


def knots(duration: float) -> FloatArray:
    """Choose the times at which a motion is planned."""
    return np.linspace(-LEAD, duration, round((duration + LEAD) * KNOTS) + 1)


def wave(time: FloatArray, amplitude: float, frequency: float, rng: np.random.Generator) -> FloatArray:
    """Make a sum of sines with random phases that grows from rest."""
    phases = rng.uniform(0.0, 2.0 * np.pi, len(SHARES))
    parts = np.sin(2.0 * np.pi * frequency * np.outer(time, SHARES) + phases)
    return np.asarray(amplitude * rise(time) * (parts @ SIZES))


def rise(time: FloatArray) -> FloatArray:
    """Grow from 0 to 1 by a polynomial with zero velocity and acceleration at both ends."""
    s = np.clip((time + LEAD - 0.3) / RISE, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s * s))
