"""Swing: the torso is held in the air, and both legs swing."""

from __future__ import annotations

import numpy as np

from exoid.rig import Rates
from exoid.rig.ground import GroundPlant, GroundRun, JointGains, Spring
from exoid.rig.ground.simulate import RATES

from .planned_motion import follow, knots, planned_motion, wave
from .posture import planar_legs

GAINS = JointGains(stiffness=(600.0, 400.0, 200.0), damping=(30.0, 20.0, 8.0))
"""Gains of the joints, an assumption."""

CLAMP = Spring(
    point=(0.0, 0.0, 0.3),
    stiffness=(2e5, 0.0, 2e5),
    damping=(4e3, 0.0, 4e3),
    turning_stiffness=2e4,
    turning_damping=400.0,
)
"""Stand that holds the torso, an assumption: an elastic frame."""


def swing(
    plant: GroundPlant,
    duration: float = 30.0,
    *,
    scale: float = 1.0,
    frequency: float = 0.6,
    clamp: Spring = CLAMP,
    seed: int = 0,
    rates: Rates = RATES,
) -> GroundRun:
    """Let the legs of a machine swing while a stand holds its torso in the air.

    Args:
        plant: Torso and legs.
        duration: Duration of the log [s].
        scale: Factor of the amplitudes.
        frequency: Main frequency of the hip [Hz]; those of knee and ankle are higher.
        clamp: Spring between torso and stand.
        seed: Seed of the phases.
        rates: Rates and step of the simulation.

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
            q[:, leg.joints.start + k] = centre[k] + wave(time, scale * amplitude, (1 + 0.2 * k) * frequency, rng)
    base = np.tile([0.0, 1.4, 0.0], (len(time), 1))
    return follow(plant, planned_motion(plant, time, q, base, {}), GAINS, rates, spring=clamp)
