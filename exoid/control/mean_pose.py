"""The pose about which a reference moves."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Reference

INSTANTS = 64
"""Of the reference, over which angles are averaged."""


def mean_pose(reference: Reference, period: float) -> FloatArray:
    """Mean angles of a reference over a period.

    Args:
        reference: Of one leg.
        period: Of the reference, or its duration [s].

    Returns:
        Angles [rad], (n,).

    Raises:
        ExoidError: The period is not positive and finite, or the reference is of several legs.
    """
    if not 0.0 < period < np.inf:
        raise ExoidError(f"a reference over {period:g} s", remedy="give its period or duration in seconds")
    angles = [np.asarray(reference.at(period * k / INSTANTS).q) for k in range(INSTANTS)]
    if angles[0].ndim != 2 or angles[0].shape[1] != 1:
        raise ExoidError(f"a reference of shape {angles[0].shape}", remedy="give that of one leg, (n, 1)")
    return np.asarray(np.mean(angles, axis=0)[:, 0])
