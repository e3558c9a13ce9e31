"""Walking in a harness: both legs follow a stride of healthy gait."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ComplexArray, FloatArray
from exoid.experiments.gait import gait_for_leg, healthy_gait
from exoid.experiments.references import Harmonics, fit_harmonics
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import GroundPlant, GroundRun, JointGains, Spring

from .planned_motion import KNOTS, Bearing, follow, knots, planned_motion, rise
from .posture import PlanarLeg, planar_legs, total_mass

GAINS = JointGains(stiffness=(1000.0, 800.0, 250.0), damping=(40.0, 30.0, 10.0))
"""Gains of the joints, an assumption: soft enough for a foot that the ground turns."""

HARNESS = Spring(
    point=(-0.1, 0.0, 0.3),
    stiffness=(10000.0, 0.0, 10000.0),
    damping=(600.0, 0.0, 600.0),
    turning_stiffness=4000.0,
    turning_damping=150.0,
)
"""Harness between torso and carriage, an assumption."""

NEAR = 0.01
"""Height over which load passes from one point of a sole to another [m]."""

TILT_DEG = (
    (0.0, 0.08, 0.36, 0.5, 0.6, 0.66, 0.75, 0.85, 0.95, 1.0),
    (14.0, 0.0, 0.0, -20.0, -60.0, -66.0, -45.0, -10.0, 14.0, 14.0),
)
"""Phases of the stride and angles of the sole to the ground [deg], an assumption: heel strike, flat, toe-off, swing."""


def walking(plant: GroundPlant, duration: float = 30.0, *, period: float = 1.4) -> GroundRun:
    """Let a machine walk in a harness whose carriage moves over the ground, which is the same as a treadmill.

    Height and speed of the carriage are those at which the lowest point of the soles would stand still. A foot that
    swings is lifted by up to 1.5 cm more than in the stride.

    Args:
        plant: Torso and two legs.
        duration: Duration of the log [s].
        period: Time of a stride of :func:`exoid.experiments.healthy_gait` [s].

    Returns:
        The run, with the wrench of the harness on the torso.

    Raises:
        ExoidError: MuJoCo is not installed, a leg does not have hip, knee, ankle and a sole, or the motion cannot be
            followed.
    """
    time, legs = knots(duration), planar_legs(plant)
    phase = np.linspace(0.0, 1.0, 400, endpoint=False)
    flexion = fit_harmonics(period * phase, healthy_flexion(phase, 0.9), period, 8)
    q = _walking_angles(plant.leg, legs, time, flexion, period)
    base = np.zeros((len(time), 3))
    places = {leg.foot: leg.points(base, q) for leg in legs}
    window = 0.03 * period * KNOTS  # smooths speed and height of the torso
    bearing = _bearings(plant, places, window)
    low = np.min([place.imag.min(axis=1) for place in places.values()], axis=0)
    # the torso travels so that the feet that bear it stand still
    speeds = [np.gradient(place.real.mean(axis=1), 1.0 / KNOTS) * bearing[foot].share for foot, place in places.items()]
    speed = -np.sum(speeds, axis=0) / np.sum([each.share for each in bearing.values()], axis=0)
    base[:, 0] = np.cumsum(scipy.ndimage.gaussian_filter1d(speed, window)) / KNOTS
    base[:, 1] = scipy.ndimage.gaussian_filter1d(-low, window)
    for leg in legs:
        foot = places[leg.foot] + (base[:, :1] + 1j * base[:, 1:2])
        tilt = np.angle(foot[:, -1] - foot[:, 0]) - np.angle(leg.sole[-1] - leg.sole[0])
        height = np.maximum(foot.imag.min(axis=1), 0.0)
        lift = 0.015 * height / (height + NEAR)  # [m] while it swings: soles are longer than feet, and legs yield
        q[:, leg.joints] = leg.angles(base, foot.mean(axis=1) + 1j * lift, tilt)
    support = 0.2  # share of the weight that the harness bears
    motion = planned_motion(plant, time, q, base, bearing, held=True, borne=1.0 - support)
    raised = base + np.array([0.0, support * GRAVITY * total_mass(plant) / HARNESS.stiffness[2], 0.0])
    motion = replace(motion, base=raised)  # the carriage is above the torso that hangs on it
    return follow(plant, motion, GAINS, spring=HARNESS)


def _bearings(plant: GroundPlant, places: dict[str, ComplexArray], window: float) -> dict[str, Bearing]:
    """Plan which points of the soles bear the machine: the lowest ones."""
    heights = {foot: place.imag for foot, place in places.items()}
    low = np.min([height.min(axis=1) for height in heights.values()], axis=0)
    loads = {foot: np.exp(-(height - low[:, None]) / NEAR) for foot, height in heights.items()}
    total = np.sum([load.sum(axis=1) for load in loads.values()], axis=0)
    out = {}
    for foot, load in loads.items():
        point = load @ plant.soles[foot].points / load.sum(axis=1, keepdims=True)
        share = scipy.ndimage.gaussian_filter1d(np.clip(load.sum(axis=1) / total, 1e-3, 1.0), window)
        out[foot] = Bearing(share, scipy.ndimage.gaussian_filter1d(point, window, axis=0))
    return out


def healthy_flexion(phase: FloatArray, scale: float) -> FloatArray:
    """Flexion of hip, knee and ankle of healthy gait at phases of the stride from heel contact [rad], (K, 3)."""
    hip, knee = healthy_gait(scale, 1.0).over(phase).q.T
    knee = knee + np.deg2rad(5.0)  # the knee of the published stride is straight at heel contact
    tilt = scipy.interpolate.PchipInterpolator(*TILT_DEG)(phase)
    return np.column_stack([hip, knee, np.deg2rad(scale * tilt) - hip + knee])


def _walking_angles(
    machine: Leg, legs: tuple[PlanarLeg, ...], time: FloatArray, flexion: Harmonics, period: float
) -> FloatArray:
    """Let all legs follow a stride, evenly apart, that grows from its mean posture."""
    q = np.zeros((len(time), len(machine.joint_names)))
    for number, leg in enumerate(legs):
        own = Leg.from_description(machine.description, machine.joint_names[leg.joints])
        motion = gait_for_leg(own, flexion, dict(zip(own.joint_names, ("hip", "knee", "ankle"), strict=True)))
        argument = motion.frequency * (time + number / len(legs) * period)[:, None, None, None] + motion.phase
        swing = (motion.amplitude * np.sin(argument)).sum(axis=1)
        q[:, leg.joints] = (motion.centre + rise(time)[:, None, None] * swing)[..., 0]
    return q
