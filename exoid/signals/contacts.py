"""Contacts found from a measured wrench or from a foot switch, with hysteresis."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError

from . import checks
from .recording import Recording
from .wrench import Wrench

TOUCH, LIFT = 0.1, 0.05
"""Default thresholds of the normal force, over its largest one.

Noise of a plate (2 to 4 N) is far below 5 % of what a wearer and an exoskeleton weigh (800 N).
"""

LEAST_LOAD = 20.0
"""Largest normal force below which nobody stood on the link [N]."""


def contacts_from_wrench(
    wrench: Wrench, *, touch: float = TOUCH, lift: float = LIFT, up: ArrayLike = (0.0, 0.0, 1.0)
) -> BoolArray:
    """Find when a link is on the ground from its normal force f · up.

    Contact begins where the force exceeds ``touch`` times its largest one, and ends where it falls below ``lift`` times
    that. Before the first of both, the link is taken to do the opposite: before it touches, it is in the air.

    Args:
        wrench: Wrench on the link.
        touch: Threshold of touch-down, over the largest normal force.
        lift: Threshold of lift-off, over the largest normal force; less than ``touch``.
        up: Direction of the normal force, away from the ground, in the axes of the wrench, (3,).

    Returns:
        Samples in contact, (N,).

    Raises:
        ExoidError: Thresholds are not 0 < lift < touch < 1, nobody stands on the link or always stands on it, or the
            force points into the ground.

    Example:
        >>> fz = 400.0 * np.maximum(0.0, np.sin(np.arange(12) * 0.6))
        >>> foot = Wrench(np.outer(fz, (0.0, 0.0, 1.0)), np.zeros((12, 3)))
        >>> contacts_from_wrench(foot).astype(int)
        array([0, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 1])
    """
    if not 0.0 < lift < touch < 1.0:
        raise BadArgumentError(
            f"thresholds touch={touch} and lift={lift} of a contact",
            remedy=f"give shares of the largest force, 0 < lift < touch < 1, such as touch={TOUCH}, lift={LIFT}",
        )
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
    return _hysteresis(
        normal,
        touch * largest,
        lift * largest,
        f"the normal force stays above {lift * largest:.4g} N ({lift:g} of its largest)",
    )


def contacts_from_switch(values: ArrayLike, on: float, off: float) -> BoolArray:
    """Find when a foot switch or a pressure sensor is pressed.

    Args:
        values: Readings in any unit, (N,).
        on: Reading beyond which the foot is on the ground.
        off: Reading beyond which, in the other direction, it has left the ground; larger than ``on`` for a sensor whose
            reading falls under load.

    Returns:
        Samples in contact, (N,).

    Raises:
        ExoidError: A reading is missing, both thresholds are equal, or the readings cross only one of them.

    Example:
        >>> contacts_from_switch([0.1, 2.0, 4.5, 3.0, 4.0, 2.0, 0.2], on=4.0, off=1.0).astype(int)
        array([0, 0, 1, 1, 1, 1, 0])
    """
    readings = checks.as_numbers(values, "readings of a foot switch")
    checks.refuse_shape(readings, (readings.size,), "readings of a foot switch")
    if not np.isfinite(readings).all():
        row = int(np.argmin(np.isfinite(readings)))
        raise BadArgumentError(f"reading {row} of a foot switch is {readings[row]}", remedy="leave those samples out")
    if not (np.isfinite(on) and np.isfinite(off)) or on == off:
        raise BadArgumentError(
            f"thresholds on={on} and off={off} of a foot switch",
            remedy="give two readings, so that noise at one of them does not switch the contact",
        )
    sign = 1.0 if on > off else -1.0
    if not readings.size or not (sign * readings > sign * on).any():
        ends = f"{readings.min():.4g} to {readings.max():.4g}" if readings.size else "no reading"
        raise BadArgumentError(
            f"the foot switch is never pressed: readings of {ends}, and on={on:g}",
            remedy="give thresholds in the unit of the readings",
        )
    return _hysteresis(
        sign * readings, sign * on, sign * off, f"the foot switch is never released (readings never beyond off={off:g})"
    )


def settled(contact: ArrayLike, time: FloatArray, margin: float) -> BoolArray:
    """Leave out touch-down and lift-off: select samples whose contact has lasted and will last some time.

    What was before the first sample and after the last one is not known, so that the ends of the log are left out too.
    ``settled(~contact, time, margin)`` are the samples in the air.

    Args:
        contact: Samples in contact, (N,).
        time: Time stamps [s], (N,).
        margin: Time after touch-down and before lift-off [s].

    Returns:
        The selected samples, (N,).

    Raises:
        ExoidError: The margin is negative, or lengths differ.

    Example:
        >>> settled([0, 1, 1, 1, 1, 1, 0, 1, 1], np.arange(9) * 0.01, 0.01).astype(int)
        array([0, 0, 1, 1, 1, 0, 0, 0, 0])
    """
    if not margin >= 0.0:
        raise BadArgumentError(f"a margin of {margin} s", remedy="give seconds, 0 for none")
    touching = np.asarray(contact, dtype=np.bool_)
    checks.refuse_shape(touching, time.shape, "contact")
    edges = np.flatnonzero(np.diff(touching, prepend=False, append=False))
    selected = np.zeros(len(time), dtype=np.bool_)
    tolerance = 1e-6 * float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    for first, stop in zip(edges[::2], edges[1::2], strict=True):
        span = time[first:stop]
        selected[first:stop] = (span - span[0] >= margin - tolerance) & (span[-1] - span >= margin - tolerance)
    return selected


def depends_on_contacts(recording: Recording) -> bool:
    """Tell whether rows depend on contacts: by forces that were not measured, or by jolts under passive joints."""
    return bool({*recording.contacts} - {*recording.wrenches} or (recording.contacts and recording.passive))


def _hysteresis(values: FloatArray, on: float, off: float, never: str) -> BoolArray:
    """Follow values that switch on above one threshold, and off below another."""
    above, below = values > on, values < off
    if not below.any():
        raise BadArgumentError(
            never,
            remedy="if the foot stands throughout, give the contact as np.ones(N, dtype=bool); otherwise raise the "
            "threshold of lift-off, or take out the sensor's offset",
        )
    decided = above | below
    last = np.maximum.accumulate(np.where(decided, np.arange(len(values)), -1))
    before = not above[int(np.argmax(decided))]
    return np.where(last >= 0, above[np.maximum(last, 0)], before)
