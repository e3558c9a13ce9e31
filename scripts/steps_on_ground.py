"""Steps on level ground, a slope and stairs as functions, balanced over flat soles without hands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ComplexArray, FloatArray
from exoid.control.functions import PHASE, SIDES, Function, legs_flexion, minimum_jerk
from exoid.experiments.ground.posture import centre_of_mass, planar_legs
from exoid.rig.ground import GroundPlant

REACH = 0.985
"""Largest distance from hip to ankle over the length of a straight leg."""

AHEAD = 0.02
"""Distance of the centre of mass before the toe of the foot behind from which that foot may turn about it [m]."""


@dataclass(frozen=True)
class Steps:
    """Size and time of steps, assumptions for BLEEX alone.

    Attributes:
        length: Length of a step forward [m].
        climb: Height of a step [m]; negative goes down.
        slope: Angle by which the ground rises forward [rad].
        seconds: Time of a step [s].
        double: Share of a step with both feet on the ground.
        height: Largest height of the root link above a foot [m].
        lean: Pitch of the torso [rad]; negative leans forward.
        lift: Height of a swinging foot above the way from step to step [m].
        toe: Angle by which the foot behind turns about its toe before it leaves [rad].
        dip: Angle by which a swinging foot points down [rad].
    """

    length: float = 0.25
    climb: float = 0.0
    slope: float = 0.0
    seconds: float = 2.0
    double: float = 0.5
    height: float = 0.9
    lean: float = -0.25
    lift: float = 0.05
    toe: float = 0.0
    dip: float = 0.2


STAIRS_UP = Steps(0.29, 0.12, seconds=3.0, double=0.6, height=0.93, lean=-0.35, toe=0.8, dip=0.7)
STAIRS_DOWN = Steps(0.29, -0.12, seconds=3.0, double=0.6, height=0.95, lean=-0.35, toe=0.6, dip=0.7)
"""Stairs of 0.12 m: up 0.17 m the knee would need 146 N·m of its 125, and down the ankle behind more than 45°."""

Foot = tuple[ComplexArray, FloatArray]
"""Place of the middle of a sole [m] and its tilt [rad], over the phase."""


def stepping(plant: GroundPlant, steps: Steps) -> dict[str, Function]:
    """Plan "stand", a "first step" with the left foot, "steps" as a cycle, and a "last step".

    The centre of mass moves forward at constant speed, so that it needs no force along the ground, and stands over the
    sole of the foot that bears alone. The hip is as high as both legs reach.

    Args:
        plant: Torso and two legs with hip, knee, ankle and sole.
        steps: Size and time of steps.

    Returns:
        The functions. The first three begin where the one before ends; steps end where they begin.

    Raises:
        ExoidError: A leg does not have hip, knee, ankle and a sole, or a foot is out of reach.
    """
    L, d, T, p = steps.length, steps.double, steps.seconds, PHASE
    way, zero = L + 1j * steps.climb, (0j * PHASE, 0.0 * PHASE)
    half = 0.5 * float(np.ptp(planar_legs(plant)[0].sole.real))
    off, behind = 0.5 + 0.5 * d, -L * (0.5 + 0.5 * d)  # phase of lift-off; the centre of mass at touch-down
    turns = min(0.5 + (half + AHEAD - L * (0.5 - 0.5 * d)) / (2.0 * L), off - 0.05)  # phase at which a toe may be used

    def cycle(u: FloatArray) -> Foot:
        """Foot that landed at phase 0 and lands again at 1, for phases to 1.35."""
        late = u < 0.35
        place, tilt = _swing(steps, np.where(late, u + 1.0, u), (turns, off, 1.0), 2.0 * way, half)
        return place - 2.0 * way * late, tilt

    swing = (1.0 - off) * 2.0 * T  # its time [s]
    both, left, right = frozenset(SIDES), frozenset(SIDES[:1]), frozenset(SIDES[1:])
    out = {"stand": _placed(plant, steps, "stand", 1.0, 0.0 * p, (zero, zero), ((0.0, both),))}
    first, last = 0.8 + swing, d * T + swing + 0.8
    com = scipy.interpolate.BPoly.from_derivatives([0, 0.5, first], [[-L, 0, 0], [-L, 0, 0], [behind, L / T, 0]])
    foot = _swing(steps, p, (0.8 / first - 0.05, 0.8 / first, 1.0), way, half, toe=0.0)
    feet = (foot[0] - way, foot[1]), (zero[0] - way, zero[1])
    order = ((0.0, both), (0.8 / first, right), (1.0, both))
    out["first step"] = _placed(plant, steps, "first step", first, com(first * p), feet, order)
    place, tilt = cycle(np.where(p < 0.5, p + 0.5, p - 0.5))
    feet = cycle(p), (place + np.where(p < 0.5, -way, way), tilt)
    order = ((0.0, both), (0.5 * d, left), (0.5, both), (off, right))
    out["steps"] = _placed(plant, steps, "steps", 2.0 * T, behind + 2.0 * L * p, feet, order, cyclic=True)
    com = scipy.interpolate.BPoly.from_derivatives(
        [0, d * T + 0.5 * swing, last], [[behind, L / T, 0], [0, 0, 0], [0, 0, 0]]
    )
    leaves, lands = d * T / last, (d * T + swing) / last
    place, tilt = cycle(np.minimum(p * last / (2.0 * T), 0.34))
    foot = _swing(steps, p, (leaves * (turns - 0.5) / (off - 0.5), leaves, lands), way, half)
    order = ((0.0, both), (leaves, left), (lands, both))
    feet = (place, tilt), (foot[0] - way, foot[1])
    out["last step"] = _placed(plant, steps, "last step", last, com(last * p), feet, order, room=0.1)
    return out


def _swing(
    steps: Steps, u: FloatArray, phases: tuple[float, float, float], way: complex, half: float, toe: float | None = None
) -> Foot:
    """Foot that turns about its toe, leaves and lands at three phases; up before forward, and forward before down."""
    turns, leaves, lands = phases
    s = np.clip((u - leaves) / (lands - leaves), 0.0, 1.0)
    wait, pace = (0.3, 0.62) if steps.climb > 0.0 else (0.0, 0.8 if steps.climb < 0.0 else 0.9)
    forward, up = minimum_jerk((s - wait) / pace), minimum_jerk(s / 0.6 if steps.climb > 0.0 else 2.0 * s - 1.0)
    lift = steps.lift * (minimum_jerk(s / 0.45) - minimum_jerk(2.0 * s - 1.0))
    turned = minimum_jerk((u - turns) / (leaves - turns)) - minimum_jerk((s - 0.15) / 0.5)
    tilt = -(steps.toe if toe is None else toe) * turned - steps.dip * np.sin(np.pi * s) ** 2
    return way.real * forward + 1j * (way.imag * up + lift) + half * (1.0 - np.exp(1j * tilt)), tilt


def _placed(
    plant: GroundPlant,
    steps: Steps,
    name: str,
    seconds: float,
    com: FloatArray,
    feet: Sequence[Foot],
    order: tuple[tuple[float, frozenset[str]], ...],
    *,
    cyclic: bool = False,
    room: float = 0.5,
) -> Function:
    """Function with the centre of mass and the soles at their places, and the hip as high as both legs reach."""
    legs, turn, base = planar_legs(plant), np.exp(1j * steps.slope), np.zeros((len(PHASE), 3))
    feet = [(place * turn, tilt + steps.slope) for place, tilt in feet]
    com, climbs = com * np.cos(steps.slope), 2.0 * ((steps.length + 1j * steps.climb) * turn).imag * cyclic * PHASE
    base[:, 0], base[:, 2], mode = com, steps.lean, "wrap" if cyclic else "nearest"
    q = np.zeros((len(PHASE), len(plant.leg.joint_names)))
    for _ in range(15):
        room_above = []
        for leg, (place, tilt) in zip(legs, feet, strict=True):
            ankle, hip = place - np.exp(1j * tilt) * leg.sole.mean(), np.exp(1j * steps.lean) * leg.hip
            reach = REACH * (abs(leg.thigh) + abs(leg.shank))
            up = np.sqrt(np.maximum(reach**2 - (base[:, 0] + hip.real - ankle.real) ** 2, 0.01))
            room_above.append(np.minimum(ankle.imag + up - hip.imag, place.imag + steps.height))
        height = (np.min(room_above, axis=0) - climbs)[: len(PHASE) - cyclic]
        height = scipy.ndimage.minimum_filter1d(height, 13, mode=mode)
        height = scipy.ndimage.gaussian_filter1d(height, 5, mode=mode)
        base[:, 1] = (np.append(height, height[0]) if cyclic else height) + climbs
        for leg, (place, tilt) in zip(legs, feet, strict=True):
            q[:, leg.joints] = leg.angles(base, place, tilt)
        base[:, 0] += com - centre_of_mass(plant, base, q)
    return Function(name, seconds, legs_flexion(plant.leg, q), base, order, cyclic, room)
