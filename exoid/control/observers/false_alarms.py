"""Threshold of a detector for a rate of false alarms: level crossings of sampled Gaussian noise (Rice 1945)."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid.errors import ExoidError

HIGHEST = 30.0
"""Largest threshold in standard deviations."""


def crossings_per_minute(level: float, correlation: float, rate: float) -> float:
    r"""Rate at which Gaussian noise crosses ±level outwards.

    A sample below the level u is followed by one above it with probability 2 T(u, √((1 − ρ)/(1 + ρ))), with T Owen's
    function and ρ the correlation of a sample with the next. For a fine time step this is Rice's formula
    (σ_ẋ / 2π σ_x) exp(−u²/2) (Rice 1945), which has no limit for the observer's noise in continuous time.

    Args:
        level: Level u in standard deviations.
        correlation: Correlation ρ of a sample with the next.
        rate: Sampling rate [Hz].

    Returns:
        Crossings per minute, both signs.
    """
    slope = np.sqrt((1.0 - correlation) / (1.0 + correlation))
    return float(60.0 * rate * 2.0 * 2.0 * scipy.special.owens_t(level, slope))


def threshold(per_minute: float, correlation: float, rate: float) -> float:
    """Find the level that noise crosses so often.

    Args:
        per_minute: False alarms per minute.
        correlation: Correlation of a sample with the next.
        rate: Sampling rate [Hz].

    Returns:
        Level in standard deviations; 0 if noise never crosses so often.

    Raises:
        ExoidError: The rate of false alarms is not positive and finite.
    """
    if not 0.0 < per_minute < np.inf:
        raise ExoidError(f"{per_minute} false alarms per minute", remedy="give a positive number, such as 1e-3")
    held = float(np.clip(correlation, -1.0 + 1e-9, 1.0 - 1e-12))

    def excess(level: float) -> float:
        """Logarithm of the rate of crossings over the wanted one."""
        crossings = max(crossings_per_minute(level, held, rate), 1e-300)
        return float(np.log(crossings / per_minute))

    if excess(0.0) <= 0.0:
        return 0.0
    return float(scipy.optimize.brentq(excess, 0.0, HIGHEST))
