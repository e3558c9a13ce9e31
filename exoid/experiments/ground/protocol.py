"""Fixed protocol on the ground: squats, shifts, bows and leg swings, as large as a machine and its limits allow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import MotionLimits
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import GroundMotion, GroundPlant

from .planned_motion import LEAD, Bearing, force_on_one_foot, knots, planned_motion, rise
from .posture import PlanarLeg, planar_legs, stand_flat, total_mass


class Wave(NamedTuple):
    """Sum of a slow and a fast sine. The slow one covers the range, the fast one tells inertia, rotor and friction."""

    slow: float  # amplitude of the slow sine
    fast: float  # amplitude of the fast sine


@dataclass(frozen=True)
class Protocol:
    """Motion about a posture; lengths are shares of the length of a leg, angles in rad, frequencies in Hz."""

    slow: float  # frequency of the slow sines
    fast: float  # frequency of the fast sines
    height: float  # height of the hip above the ankle
    squat: Wave  # height of the torso
    lean: float  # mean pitch of the torso; negative leans forward
    bow: Wave  # pitch
    shift: Wave  # centre of pressure forward [m]
    swing: tuple[Wave, Wave, Wave] = (Wave(0.0, 0.0),) * 3  # hip, knee and ankle of a leg in the air
    flexion: tuple[float, float, float] = (0.0, 0.0, 0.0)  # their mean flexion


# Rounded result of random changes that make the worst standard deviation of BLEEX smaller, such as those of
# `scripts/study_stance_plan.py --changes 150`. Chosen for BLEEX: another machine has another optimum.
ON_ALL_FEET = Protocol(0.15, 0.9, 0.9, Wave(0.06, 0.01), -0.25, Wave(0.3, 0.05), Wave(0.04, 0.01))
ON_ONE_FOOT = Protocol(
    slow=0.24,
    fast=1.1,
    height=0.94,
    squat=Wave(0.01, 0.003),
    lean=-0.3,
    bow=Wave(0.18, 0.04),
    shift=Wave(0.01, 0.005),
    swing=(Wave(0.9, 0.25), Wave(-0.15, 0.2), Wave(0.2, 0.1)),  # the knee bends where the foot passes the ground
    flexion=(1.0, 1.55, 0.15),
)

FRICTION = 0.4
"""Coefficient of friction that a motion may use, below that of usual floors."""

SOLE_MARGIN = 0.02
"""Distance of the centre of pressure from heel and toe [m]."""

LOAD = (0.5, 1.5)
"""Vertical force over the weight of the machine."""

PITCH = np.deg2rad([-40.0, 10.0])
"""Pitch of the torso forward and backward [rad]."""

KNEE = np.deg2rad(15.0)
"""Smallest flexion of a knee [rad]: at a straight knee a foot leaves no row of the equation."""

CLEARANCE = 0.03
"""Height of a foot in the air [m]."""


class ProtocolMotion(NamedTuple):
    """Motion of the protocol with its margins."""

    feet: tuple[str, ...]  # links of the feet that stand
    motion: GroundMotion  # motion that begins at rest before time zero
    share: float  # share of the amplitudes of the protocol that the limits allow
    margins: dict[str, float]  # smallest margin to each limit, in its unit or as a share of the limit


def protocol_motion(
    plant: GroundPlant,
    stands: tuple[PlanarLeg, ...],
    duration: float,
    limits: MotionLimits,
    *,
    friction: float = FRICTION,
    number: int = 0,
) -> ProtocolMotion:
    """Make the largest motion of the protocol on some feet that keeps all limits; the number shifts its phases."""
    coarse = np.linspace(-LEAD, duration, round((duration + LEAD) * 20.0) + 1)
    refused: BadArgumentError | None = None
    for share in np.arange(1.0, 0.2, -0.05):  # a smaller motion tells too little
        try:
            for time in (coarse, knots(duration)):
                found = _moved(plant, stands, time, share, number)
                margins = _margins(plant, stands, found, limits, friction)
                worst = min(margins, key=lambda name: margins[name])
                if margins[worst] < 0.0:
                    refused = BadArgumentError(
                        f"squats on {', '.join(leg.foot for leg in stands)} exceed the {worst} limit",
                        where=plant.leg.description.name,
                        remedy=f"widen the {worst} limit or the angles, or give larger soles",
                    )
                    break
            else:
                return ProtocolMotion(tuple(leg.foot for leg in stands), found, float(share), margins)
        except BadArgumentError as error:  # a foot is out of reach
            refused = error
    assert refused is not None
    raise refused


def _moved(
    plant: GroundPlant, stands: tuple[PlanarLeg, ...], time: FloatArray, share: float, number: int
) -> GroundMotion:
    """Move torso and legs by a share of the protocol."""
    standing = [leg.foot for leg in stands]
    swings = [leg for leg in planar_legs(plant) if leg.foot not in standing]
    protocol = ON_ONE_FOOT if swings else ON_ALL_FEET
    size = share * rise(time - LEAD) * rise(time[-1] - LEAD - time)  # from rest to rest
    first = stands[0]
    length, ground = abs(first.thigh) + abs(first.shank), first.sole.mean().imag + first.hip.imag

    def wave(each: Wave, frequencies: tuple[float, float], phases: tuple[int, int]) -> FloatArray:
        """Slow and fast sine with frequencies as shares of those of the protocol."""
        turns = 2.0 * np.pi * np.array(frequencies) * (protocol.slow, protocol.fast)
        sines = np.sin(np.outer(time, turns) + np.array([0.9, 2.1]) * (np.array(phases) + number))
        return np.asarray(size * (sines @ each))

    base = np.zeros((len(time), 3))
    base[:, 1] = length * (protocol.height + wave(protocol.squat, (1.3, 1.0), (1, 1))) - ground
    base[:, 2] = protocol.lean + wave(protocol.bow, (1.0, 0.83), (2, 2))
    q = np.zeros((len(time), len(plant.leg.joint_names)))
    for leg in swings:
        frequencies = ((1.15, 1.0), (1.15, 1.37), (0.77, 1.81))
        waves = [wave(*each, (0, k)) for k, each in enumerate(zip(protocol.swing, frequencies, strict=True))]
        q[:, leg.joints] = leg.flexion(*protocol.flexion) + np.column_stack(waves)
    _balance(plant, time, q, stands, base, wave(protocol.shift, (1.7, 1.2), (3, 3)))
    feet = {leg.foot: Bearing(np.ones_like(time), plant.soles[leg.foot].centre) for leg in stands}
    return planned_motion(plant, time, q, base, feet, degree=7)


def _balance(
    plant: GroundPlant,
    time: FloatArray,
    q: FloatArray,
    stands: tuple[PlanarLeg, ...],
    base: FloatArray,
    target: FloatArray,
) -> None:
    """Move torso and standing legs until the centre of pressure is at its target, from the middle of the soles."""
    # The centre of pressure of a mass at height h is x - h ẍ / g. The inverse of that filter turns its error into a
    # shift of the torso; a few times, as the legs are not massless. The motion is periodic: it begins and ends at rest.
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(time) - 1, float(time[1] - time[0]))
    inverse = 1.0 / (1.0 + base[:, 1].mean() * omega**2 / GRAVITY)
    for _ in range(10):
        stand_flat(q, stands, base)
        _, up, moment = force_on_one_foot(plant, time, q, base, stands[0].foot).T
        error = (target - moment / up)[:-1]
        shift = np.fft.irfft(inverse * np.fft.rfft(error), len(error))
        base[:, 0] += np.append(shift, shift[0])
    stand_flat(q, stands, base)


def _margins(
    plant: GroundPlant, stands: tuple[PlanarLeg, ...], motion: GroundMotion, limits: MotionLimits, friction: float
) -> dict[str, float]:
    """Smallest margins of a motion to all limits, negative where one is exceeded."""
    time, q, base = motion.time, motion.q, motion.base
    joints, first = scipy.interpolate.CubicSpline(time, q), stands[0]
    forward, up, moment = force_on_one_foot(plant, time, q, base, first.foot).T
    load, reach = up / (GRAVITY * total_mass(plant)), 0.5 * np.ptp(first.sole.real) - SOLE_MARGIN
    legs = planar_legs(plant)
    margins = {
        "angle": np.minimum(q - limits.lower, limits.upper - q),
        "knee": np.column_stack([leg.knee * q[:, leg.joints.start + 1] for leg in legs]) - KNEE,
        "velocity": 1.0 - np.abs(joints(time, 1)) / limits.velocity,
        "acceleration": 1.0 - np.abs(joints(time, 2)) / limits.acceleration,
        "torque": 1.0 - np.abs(motion.torque) / limits.torque,
        "least load": load - LOAD[0],
        "most load": LOAD[1] - load,
        "friction": friction - np.abs(forward) / up,
        "centre of pressure": reach - np.abs(moment / up),
        "torso": np.minimum(base[:, 2] - PITCH[0], PITCH[1] - base[:, 2]),
    }
    standing = [leg.foot for leg in stands]
    swings = [leg.points(base, q).imag for leg in legs if leg.foot not in standing]
    if swings:
        margins["clearance"] = np.hstack(swings) - CLEARANCE
    return {name: float(each.min()) for name, each in margins.items()}
