"""Contacts found from a measured wrench, with hysteresis."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, BoolArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg

from . import checks
from .poses import Poses
from .recording import Recording
from .wrench import Wrench

TOUCH, LIFT = 0.1, 0.05
"""Thresholds of the normal force at touch-down and lift-off, over its largest one.

Noise of a plate (2 to 4 N) is far below 5 % of what a wearer and an exoskeleton weigh (800 N).
"""

LEAST_LOAD = 20.0
"""Largest normal force below which nobody stood on the link [N]."""


def contacts_from_wrench(wrench: Wrench, *, up: ArrayLike = (0.0, 0.0, 1.0)) -> BoolArray:
    """Find when a link is on the ground from its normal force f · up.

    Contact begins where the force exceeds 10 % of its largest one, and ends where it falls below 5 %. Before the first
    of both, the link is taken to do the opposite: before it touches, it is in the air.

    Args:
        wrench: Wrench on the link.
        up: Direction of the normal force, away from the ground, in the axes of the wrench, (3,).

    Returns:
        Samples in contact, (N,).

    Raises:
        ExoidError: Nobody stands on the link or always stands on it, or the force points into the ground.

    Example:
        >>> fz = 400.0 * np.maximum(0.0, np.sin(np.arange(12) * 0.6))
        >>> foot = Wrench(np.outer(fz, (0.0, 0.0, 1.0)), np.zeros((12, 3)))
        >>> contacts_from_wrench(foot).astype(int)
        array([0, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 1])
    """
    normal = wrench.force @ checks.as_direction(up)
    low, largest = np.quantile(normal, [0.01, 0.99]).tolist()  # so that an impact does not raise the thresholds
    if largest < LEAST_LOAD:
        downwards = low < -LEAST_LOAD
        raise BadArgumentError(
            f"the normal force goes from {low:.4g} N to {largest:.4g} N: "
            + ("it points into the ground" if downwards else f"nobody stands on the link (limit {LEAST_LOAD:g} N)"),
            remedy="change its sign: a wrench acts on the leg, not on the ground; or give the direction up="
            if downwards
            else "check the unit (N) and the direction up=, or leave the contact out",
        )
    above, below = normal > TOUCH * largest, normal < LIFT * largest
    if not below.any():
        raise BadArgumentError(
            f"the normal force stays above {LIFT * largest:.4g} N ({LIFT:g} of its largest)",
            remedy="if the foot stands throughout, give the contact as np.ones(N, dtype=bool); otherwise take out the "
            "sensor's offset",
        )
    last = np.maximum.accumulate(np.where(above | below, np.arange(len(normal)), -1))
    before = not above[int(np.argmax(above | below))]
    return np.where(last >= 0, above[np.maximum(last, 0)], before)


def stands(leg: Leg, data: Recording | Poses) -> bool:
    """Tell whether rows depend on contacts: by forces that were not measured, or by jolts under passive joints."""
    unmeasured = isinstance(data, Recording) and {*data.contacts} - {*data.wrenches}
    return bool(leg.base_rows or unmeasured or (isinstance(data, Recording) and data.contacts and data.passive))
