"""Climb or descend stairs foot over foot."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid.experiments.references import minimum_jerk
from exoid.tools.numbers import checked

from .body import SIDES, Body
from .function import PHASE, Function, placed

STAIR_TILT_DEG = {
    True: ((0.0, 0.6, 0.68, 0.8, 0.86, 0.95, 1.0), (0.0, 0.0, -12.0, -35.0, -30.0, -4.0, 0.0)),
    False: ((0.0, 0.3, 0.62, 0.75, 0.85, 0.95, 1.0), (0.0, 0.0, -30.0, -40.0, -25.0, 0.0, 0.0)),
}
"""Phases from a foot's own contact and angles of its sole on stairs [deg], up and down, by the range of the ankle."""


def stairs(body: Body, *, up: bool = True, riser: float = 0.17, tread: float = 0.29, period: float = 2.4) -> Function:
    """Climb or descend stairs foot over foot; phase 0 is the contact of the left foot with the first step.

    Args:
        body: The wearer.
        up: Whether up, or down.
        riser: Height of a step [m].
        tread: Depth of a step [m].
        period: Time of two steps [s].

    Returns:
        The function. The right foot begins at the origin, one step behind.

    Raises:
        ExoidError: The steps are too high or too deep for the legs.
    """
    checked([riser, tread], "riser and tread [m]", above=0.0, most=0.6)
    step = tread + 1j * (riser if up else -riser)
    lift_off = 0.62  # phase of its own contact at which a foot leaves
    own = {"left": PHASE, "right": (PHASE + 0.5) % 1.0 + (PHASE == 0.5)}
    begin = {"left": np.full(len(PHASE), step), "right": np.where(PHASE <= 0.5, 0.0, 2.0 * step)}
    tilt = {side: np.deg2rad(scipy.interpolate.PchipInterpolator(*STAIR_TILT_DEG[up])(u)) for side, u in own.items()}
    if body.ankle == 0.0:
        tilt = dict.fromkeys(SIDES, 0.0 * PHASE)
    feet = {}
    for side, u in own.items():
        s = np.clip((u - lift_off) / (1.0 - lift_off), 0.0, 1.0)  # of its swing: up before forward, forward before down
        early, late = minimum_jerk(s / 0.7), minimum_jerk((s - 0.3) / 0.7)
        forward, raised = (late, early) if up else (early, late)
        clearance = 0.05 * np.sin(np.pi * s) ** 2
        swing = 2.0 * step.real * forward + 1j * (2.0 * step.imag * raised + clearance)
        # a foot turns about its toe, whose place is that of a level sole
        turned = 0.5 * (body.toe - body.heel) * (1.0 - np.exp(1j * tilt[side]))
        feet[side] = begin[side] + swing + turned
    ahead, height = (0.3, 0.90) if up else (0.2, 0.94)
    # the hip rises or sinks while one foot bears it: at touch-down the leg behind, or that ahead, is long
    sunk = (2.0 * PHASE) // 1.0 + minimum_jerk((2.0 * PHASE) % 1.0)
    level = riser * sunk if up else -riser * (sunk + 1.0)
    hip = tread * (2.0 * PHASE + ahead) + 1j * (height * body.leg + level)
    double = lift_off - 0.5
    sets = frozenset(SIDES), frozenset(("left",)), frozenset(SIDES), frozenset(("right",))
    order = tuple(zip((0.0, double, 0.5, 0.5 + double), sets, strict=True))
    name = "stairs up" if up else "stairs down"
    return placed(name, body, period, hip, np.zeros(len(PHASE)), order, feet=feet, tilt=tilt, cyclic=True)
