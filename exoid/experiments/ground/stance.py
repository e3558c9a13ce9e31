"""Stance: squats and weight shifts on one leg or two."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Rates
from exoid.rig.ground import GroundPlant, GroundRun, JointGains, Spring, simulate_on_ground
from exoid.rig.ground.simulate import RATES

from .feedforward import Bearing, planned_motion
from .posture import PlanarLeg, centre_of_mass, planar_legs
from .waves import knots, wave

GAINS = JointGains(stiffness=(2000.0, 2000.0, 1500.0), damping=(60.0, 60.0, 40.0))
"""Gains of the joints while they bear the machine, an assumption: stiff enough to stand."""

HAND_RAIL = Spring(
    point=(0.1, 0.0, 0.35), stiffness=(3000.0, 0.0, 1000.0), damping=(200.0, 0.0, 100.0), turning_stiffness=0.0
)
"""Hand rail, an assumption: a hand on a bar in front of the chest."""

CLEARANCE = 0.01
"""Smallest height of a foot that does not stand [m]."""

STEPS = 6
"""Corrections of the place of the torso over its feet."""


@dataclass(frozen=True)
class Stance:
    """Size and frequency of squats and weight shifts.

    Attributes:
        height: Mean height of the root link's origin above the ground [m].
        squat: Amplitude of the height [m].
        shift: Amplitude of the centre of mass forward [m]; without effect on a rail.
        bow: Amplitude of the pitch of the torso [rad]; without effect on a rail.
        lean: Mean pitch [rad]; negative leans forward. A rail keeps the torso upright.
        swing: Amplitude of the joints of a leg that does not stand [rad].
        frequency: Main frequency [Hz].
    """

    height: float = 0.88
    squat: float = 0.04
    shift: float = 0.02
    bow: float = 0.08
    lean: float = -0.25
    swing: float = 0.25
    frequency: float = 0.5


def rail_squats(
    plant: GroundPlant, duration: float = 30.0, *, stance: Stance = Stance(squat=0.06), seed: int = 0, rates: Rates = RATES
) -> GroundRun:
    """Let a leg squat while a vertical rail holds the torso, which neither moves forward nor pitches.

    Args:
        plant: Torso and one leg, or two.
        duration: Duration of the log [s].
        stance: Size and frequency of the squats.
        seed: Seed of the phases.
        rates: Rates and step of the simulation.

    Returns:
        The run, with the wrench of the rail on the torso.

    Raises:
        ExoidError: MuJoCo is not installed, a leg does not have hip, knee, ankle and a sole, or a foot is out of reach.
    """
    rng, time, legs = np.random.default_rng(seed), knots(duration), planar_legs(plant)
    height = stance.height + wave(time, stance.squat, stance.frequency, rng)
    base = np.column_stack([np.zeros_like(time), height, np.zeros_like(time)])
    hip = legs[0].hip.real
    q = _standing(plant, legs, base, np.full(len(time), hip))
    feet = {leg.foot: _bearing(plant, leg, time) for leg in legs}
    return simulate_on_ground(
        plant, planned_motion(plant, time, q, base, feet, held=True), GAINS, rail=True, rates=rates
    )


def squats_and_shifts(
    plant: GroundPlant, duration: float = 30.0, *, stance: Stance = Stance(), seed: int = 0, rates: Rates = RATES
) -> GroundRun:
    """Let a free machine squat on both feet, shift its weight fore and aft, and bow.

    Args:
        plant: Torso and legs.
        duration: Duration of the log [s].
        stance: Size and frequency of the motions.
        seed: Seed of the phases.
        rates: Rates and step of the simulation.

    Returns:
        The run.

    Raises:
        ExoidError: MuJoCo is not installed, a leg does not have hip, knee, ankle and a sole, a foot is out of reach, or
            the machine would fall.
    """
    rng, time, legs = np.random.default_rng(seed), knots(duration), planar_legs(plant)
    base, target = _torso(time, stance, rng)
    for _ in range(STEPS):
        q = _standing(plant, legs, base, np.zeros_like(time))
        base[:, 0] += target - centre_of_mass(plant, base, q)
    q = _standing(plant, legs, base, np.zeros_like(time))
    feet = {leg.foot: _bearing(plant, leg, time) for leg in legs}
    return simulate_on_ground(plant, planned_motion(plant, time, q, base, feet), GAINS, rates=rates)


def single_support(
    plant: GroundPlant,
    duration: float = 30.0,
    *,
    stance: Stance = Stance(shift=0.01, bow=0.05),
    standing: int = 0,
    hand_rail: Spring = HAND_RAIL,
    seed: int = 0,
    rates: Rates = RATES,
) -> GroundRun:
    """Let a machine stand on one foot and swing the other leg, with a hand on a rail.

    Args:
        plant: Torso and two legs.
        duration: Duration of the log [s].
        stance: Size and frequency of the motions.
        standing: Number of the leg that stands, in the order of the joints.
        hand_rail: Spring between torso and rail.
        seed: Seed of the phases.
        rates: Rates and step of the simulation.

    Returns:
        The run, with the wrench of the hand rail on the torso.

    Raises:
        ExoidError: MuJoCo is not installed, a leg does not have hip, knee, ankle and a sole, a foot is out of reach, or
            the swinging foot would touch the ground.
    """
    rng, time, legs = np.random.default_rng(seed), knots(duration), planar_legs(plant)
    stands = legs[standing : standing + 1]
    base, target = _torso(time, stance, rng)
    swings = {leg.foot: _swinging(leg, time, stance, rng) for leg in legs if leg not in stands}
    q = np.zeros((len(time), len(plant.leg.joint_names)))
    for leg in legs:
        if leg.foot in swings:
            q[:, leg.joints] = swings[leg.foot]
    for _ in range(STEPS):
        q[:, stands[0].joints] = stands[0].angles(base, np.zeros_like(time, dtype=complex), np.zeros_like(time))
        base[:, 0] += target - centre_of_mass(plant, base, q)
    q[:, stands[0].joints] = stands[0].angles(base, np.zeros_like(time, dtype=complex), np.zeros_like(time))
    refuse_touching(legs, swings, base, q)
    motion = planned_motion(plant, time, q, base, {stands[0].foot: _bearing(plant, stands[0], time)})
    return simulate_on_ground(plant, motion, GAINS, spring=hand_rail, rates=rates)


def refuse_touching(legs: tuple[PlanarLeg, ...], feet: object, base: FloatArray, q: FloatArray) -> None:
    """Refuse a motion in which a foot that should swing comes near the ground."""
    for leg in legs:
        height = float(leg.points(base, q).imag.min())
        if leg.foot in feet and height < CLEARANCE:
            raise ExoidError(
                f"{leg.foot} swings {1e3 * height:.3g} mm above the ground", remedy="raise the torso, or swing less"
            )


def _torso(time: FloatArray, stance: Stance, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Reference of the torso, and place of the centre of mass forward."""
    height = stance.height + wave(time, stance.squat, stance.frequency, rng)
    pitch = stance.lean + wave(time, stance.bow, 0.83 * stance.frequency, rng)
    target = wave(time, stance.shift, 1.21 * stance.frequency, rng)
    return np.column_stack([np.zeros_like(time), height, pitch]), target


def _swinging(leg: PlanarLeg, time: FloatArray, stance: Stance, rng: np.random.Generator) -> FloatArray:
    """Angles of a leg with a bent knee that swings, (K, 3)."""
    centre = leg.flexion(1.2, 1.8, 0.5)
    waves = [wave(time, size * stance.swing, (1.6 + 0.2 * k) * stance.frequency, rng) for k, size in enumerate((1.0, 1.2, 1.0))]
    return centre + np.column_stack(waves)


def _standing(plant: GroundPlant, legs: tuple[PlanarLeg, ...], base: FloatArray, place: FloatArray) -> FloatArray:
    """Angles of legs that stand flat at a place."""
    q = np.zeros((len(base), len(plant.leg.joint_names)))
    for leg in legs:
        q[:, leg.joints] = leg.angles(base, place.astype(complex), np.zeros(len(base)))
    return q


def _bearing(plant: GroundPlant, leg: PlanarLeg, time: FloatArray) -> Bearing:
    return Bearing(np.ones_like(time), plant.soles[leg.foot].centre)
