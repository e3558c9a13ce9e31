"""Period and harmonics of a planned motion of given duration and highest frequency."""

from __future__ import annotations

import math

from exoid.errors import ExoidError

from .fourier import Basis

PERIOD = 10.0
"""Approximate period of the Fourier series [s]."""

MOST_SAMPLES = 10**7
"""Largest number of samples of a plan: 1 kHz for almost three hours."""

FEWEST, MOST = 3, 20
"""Smallest and largest number of harmonics."""


def series(duration: float, rate: float, highest: float, samples: int) -> tuple[float, Basis]:
    """Choose period and harmonics of a motion."""
    if not (0.0 < duration < math.inf and 0.0 < rate < math.inf and 0.0 < highest < math.inf):
        raise ExoidError(
            f"{duration:g} s at {rate:g} Hz, up to {highest:g} Hz", remedy="give positive numbers in s and Hz"
        )
    if duration * rate > MOST_SAMPLES:
        raise ExoidError(
            f"{duration:g} s at {rate:g} Hz are more than {MOST_SAMPLES:.0e} samples",
            remedy="plan a shorter motion, or a lower rate: the motion itself needs few samples",
        )
    if rate < samples * highest:
        raise ExoidError(
            f"a motion of up to {highest:g} Hz at {rate:g} Hz",
            remedy=f"sample it at {samples * highest:g} Hz at least, or lower the highest frequency",
        )
    seconds = round(duration * rate) / rate
    period = seconds / max(1, round(seconds / PERIOD))
    harmonics = min(int(highest * period + 1e-9), MOST)
    if harmonics < FEWEST:
        raise ExoidError(
            f"{duration:g} s are too short for {FEWEST} harmonics up to {highest:g} Hz",
            remedy=f"plan at least {FEWEST / highest:g} s at each torso tilt, or allow higher frequencies",
        )
    return seconds, Basis.make(period, harmonics, samples * harmonics)
