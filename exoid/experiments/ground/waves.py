"""Smooth motions: sums of sines that begin at rest."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

LEAD = 2.0
"""Time in which a machine settles before the log begins [s]."""

KNOTS = 100.0
"""Rate at which motions are planned [Hz]."""


def knots(duration: float) -> FloatArray:
    """Choose the times at which a motion is planned."""
    return np.linspace(-LEAD, duration, round((duration + LEAD) * KNOTS) + 1)


def wave(time: FloatArray, amplitude: float, frequency: float, rng: np.random.Generator) -> FloatArray:
    """Make a sum of sines with random phases that grows from rest."""
    shares, sizes = np.array([(0.37, 0.5), (0.71, 0.45), (1.0, 0.4), (1.63, 0.15)]).T  # of frequency and amplitude
    phases = rng.uniform(0.0, 2.0 * np.pi, len(shares))
    parts = np.sin(2.0 * np.pi * frequency * np.outer(time, shares) + phases)
    return np.asarray(amplitude * rise(time) * (parts @ sizes))


def rise(time: FloatArray) -> FloatArray:
    """Grow from 0 to 1 by a polynomial with zero velocity and acceleration at both ends."""
    s = np.clip((time + LEAD - 0.3) / 1.5, 0.0, 1.0)  # to full size in 1.5 s
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s * s))
