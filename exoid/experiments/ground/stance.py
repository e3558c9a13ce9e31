"""Squats and weight shifts on one foot or two, and swings of legs in the air."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig.ground import GroundMotion, GroundPlant, GroundRun, JointGains, Spring

from .planned_motion import Bearing, follow, knots, planned_motion, wave
from .posture import PlanarLeg, centre_of_mass, planar_legs, stand_flat

GAINS = JointGains(stiffness=(2000.0, 2000.0, 1500.0), damping=(60.0, 60.0, 40.0))
"""Gains of the joints while they bear the machine, an assumption: stiff enough to stand."""

HAND_RAIL = Spring(point=(0.1, 0.0, 0.35), stiffness=(3000.0, 0.0, 1000.0), damping=(200.0, 0.0, 100.0))
"""Hand on a bar in front of the chest, an assumption."""

SWING_GAINS = JointGains(stiffness=(600.0, 400.0, 200.0), damping=(30.0, 20.0, 8.0))
"""Gains of the joints, an assumption."""

CLAMP = Spring(
    point=(0.0, 0.0, 0.3),
    stiffness=(2e5, 0.0, 2e5),
    damping=(4e3, 0.0, 4e3),
    turning_stiffness=2e4,
    turning_damping=400.0,
)
"""Stand that holds the torso, an assumption: an elastic frame."""


@dataclass(frozen=True)
class Stance:
    """Size and frequency of squats and weight shifts.

    Attributes:
        height: Mean height of the root link's origin above the ground [m].
        squat: Amplitude of the height [m].
        shift: Amplitude of the centre of mass forward [m].
        bow: Amplitude of the pitch of the torso [rad].
        lean: Mean pitch [rad]; negative leans forward.
        swing: Amplitude of the joints of a leg that does not stand [rad].
        frequency: Main frequency [Hz]; the others are from a third of it to twice as high.
    """

    height: float = 0.88
    squat: float = 0.04
    shift: float = 0.02
    bow: float = 0.08
    lean: float = -0.25
    swing: float = 0.25
    frequency: float = 0.5


ON_ONE_FOOT = Stance(shift=0.01, bow=0.05)
"""Motion on one foot."""


def squats_and_shifts(
    plant: GroundPlant, duration: float = 30.0, *, stance: Stance | None = None, seed: int = 0
) -> GroundRun:
    """Let a free machine squat on both feet, shift its weight fore and aft, and bow.

    Args:
        plant: Torso and legs.
        duration: Duration of the log [s].
        stance: Size and frequency of the motions; None for the default ones.
        seed: Seed of the phases.

    Returns:
        The run.

    Raises:
        ExoidError: MuJoCo is not installed, a leg does not have hip, knee, ankle and a sole, or the motion cannot be
            followed.
    """
    return follow(plant, stance_motion(plant, duration, stance=stance, seed=seed), GAINS)


def single_support(
    plant: GroundPlant, duration: float = 30.0, *, stance: Stance = ON_ONE_FOOT, standing: int = 0, seed: int = 0
) -> GroundRun:
    """Let a machine stand on one foot and swing the other leg, with a hand on a rail.

    Args:
        plant: Torso and two legs.
        duration: Duration of the log [s].
        stance: Size and frequency of the motions.
        standing: Number of the leg that stands, in the order of the joints.
        seed: Seed of the phases.

    Returns:
        The run, with the wrench of the hand rail on the torso.

    Raises:
        ExoidError: MuJoCo is not installed, a leg does not have hip, knee, ankle and a sole, there is no such leg, or
            the motion cannot be followed.
    """
    legs = planar_legs(plant)
    if not 0 <= standing < len(legs):
        raise BadArgumentError(f"no leg {standing} of {len(legs)}", remedy="count from 0")
    motion = stance_motion(plant, duration, stance=stance, standing=standing, seed=seed)
    return follow(plant, motion, GAINS, spring=HAND_RAIL)


def stance_motion(
    plant: GroundPlant,
    duration: float = 30.0,
    *,
    stance: Stance | None = None,
    standing: int | None = None,
    seed: int = 0,
) -> GroundMotion:
    """Plan squats, shifts and bows, for a law that follows them.

    Args:
        plant: Torso and legs.
        duration: Duration [s]; the motion begins 2 s before time zero.
        stance: Size and frequency of the motions; None for the default ones.
        standing: Number of the leg that stands while the others swing; None for all legs.
        seed: Seed of the phases.

    Returns:
        The reference of joints and torso, with the torques that it needs.

    Raises:
        ExoidError: A leg does not have hip, knee, ankle and a sole, or the feet are out of reach or near the ground.
    """
    stance, legs = stance or Stance(), planar_legs(plant)
    stands = legs if standing is None else legs[standing : standing + 1]
    rng, time = np.random.default_rng(seed), knots(duration)
    height = stance.height + wave(time, stance.squat, stance.frequency, rng)
    pitch = stance.lean + wave(time, stance.bow, 0.83 * stance.frequency, rng)
    target = wave(time, stance.shift, 1.21 * stance.frequency, rng)  # of the centre of mass, forward
    base = np.column_stack([np.zeros_like(time), height, pitch])
    q = np.zeros((len(time), len(plant.leg.joint_names)))
    swings = [leg for leg in legs if leg.foot not in [other.foot for other in stands]]
    for leg in swings:
        sizes = ((1.0, 1.6), (1.2, 1.8), (1.0, 2.0))  # of amplitude and frequency
        waves = [wave(time, size * stance.swing, f * stance.frequency, rng) for size, f in sizes]
        q[:, leg.joints] = leg.flexion(1.2, 1.65, 0.4) + np.column_stack(waves)
    _balance(plant, q, stands, base, target)
    for leg in swings:
        lowest = float(leg.points(base, q).imag.min())
        if (lacking := 0.01 - lowest) > 0.0:  # m
            where = f"{1e3 * abs(lowest):.3g} mm {'above' if lowest > 0.0 else 'below'} the ground"
            remedy = f"raise the torso by {np.ceil(1e3 * lacking):.0f} mm or more, or swing less"
            raise BadArgumentError(f"{leg.foot} would swing as low as {where}", remedy=remedy)
    bearings = {leg.foot: Bearing(np.ones_like(time), plant.soles[leg.foot].centre) for leg in stands}
    return planned_motion(plant, time, q, base, bearings)


def swing(plant: GroundPlant, duration: float = 30.0, *, scale: float = 1.0, seed: int = 0) -> GroundRun:
    """Let the legs of a machine swing while a stand holds its torso in the air.

    Args:
        plant: Torso and legs.
        duration: Duration of the log [s].
        scale: Factor of the amplitudes.
        seed: Seed of the phases.

    Returns:
        The run, with the wrench of the stand on the torso.

    Raises:
        ExoidError: MuJoCo is not installed, or a leg does not have hip, knee, ankle and a sole.
    """
    rng, time, legs = np.random.default_rng(seed), knots(duration), planar_legs(plant)
    q = np.zeros((len(time), len(plant.leg.joint_names)))
    for leg in legs:
        centre = leg.flexion(0.3, 0.8, 0.0)  # the ankle's is upward
        for k, amplitude in enumerate((0.35, 0.45, 0.3)):
            q[:, leg.joints.start + k] = centre[k] + wave(time, scale * amplitude, (1 + 0.2 * k) * 0.6, rng)
    base = np.tile([0.0, 1.4, 0.0], (len(time), 1))
    return follow(plant, planned_motion(plant, time, q, base, {}), SWING_GAINS, spring=CLAMP)


def _balance(
    plant: GroundPlant, q: FloatArray, legs: Sequence[PlanarLeg], base: FloatArray, target: FloatArray
) -> None:
    """Move the torso until the centre of mass is over its target, counted from the middle of the soles."""
    for _ in range(6):
        stand_flat(q, legs, base)
        base[:, 0] += target - centre_of_mass(plant, base, q)
    stand_flat(q, legs, base)
