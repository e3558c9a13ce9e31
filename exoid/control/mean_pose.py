"""Poses along a reference, and their mean."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Reference

INSTANTS = 64
"""Number of instants of a period at which poses are taken."""


def mean_pose(reference: Reference, period: float) -> FloatArray:
    """Average the angles of a reference over a period.

    Args:
        reference: Reference of one leg.
        period: Period of the reference, or its duration [s].

    Returns:
        Mean angles [rad], (n,).

    Raises:
        ExoidError: The period is not positive and finite, or the reference is that of several legs.
    """
    return np.asarray(np.mean(poses_along(reference, period), axis=0))


def poses_along(reference: Reference, period: float) -> FloatArray:
    """Take angles of a reference at :data:`INSTANTS` equally spaced instants."""
    if not 0.0 < period < np.inf:
        raise BadArgumentError(f"a reference over {period:g} s", remedy="give its period or duration in seconds")
    angles = [np.asarray(reference.at(period * k / INSTANTS).q) for k in range(INSTANTS)]
    if angles[0].ndim != 2 or angles[0].shape[1] != 1:
        raise BadArgumentError(f"a reference of shape {angles[0].shape}", remedy="give that of one leg, (n, 1)")
    return np.array(angles)[:, :, 0]
