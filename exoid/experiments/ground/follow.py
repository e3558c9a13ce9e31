"""Execution of a planned motion: refused beyond the limits of the joints, and where the machine falls."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid.errors import ExoidError
from exoid.experiments.limits import refuse_poses_beyond_limits
from exoid.rig import Rates
from exoid.rig.ground import GroundMotion, GroundPlant, GroundRun, JointGains, Spring, simulate_on_ground

FALLEN = 0.15
"""Distance of the torso from the planned height from which the machine counts as fallen [m]."""

LARGEST_ERROR = 0.35
"""Distance of a joint from its reference from which the machine does not follow [rad]: a foot is caught."""


def follow(
    plant: GroundPlant,
    motion: GroundMotion,
    gains: JointGains,
    rates: Rates,
    *,
    rail: bool = False,
    spring: Spring | None = None,
) -> GroundRun:
    """Let a machine follow a planned motion."""
    refuse_poses_beyond_limits(plant.leg, motion.q)
    run = simulate_on_ground(plant, motion, gains, rail=rail, spring=spring, rates=rates)
    planned = scipy.interpolate.CubicSpline(motion.time, np.column_stack([motion.base[:, 1], motion.q]))(run.time)
    far = np.abs(run.position @ plant.plane.up - planned[:, 0]) > FALLEN
    if far.any():
        raise ExoidError(
            f"the machine falls: at {run.time[np.argmax(far)]:.3g} s its torso is {FALLEN:g} m off the planned height",
            remedy="take smaller or slower motions, or more friction of the ground",
        )
    error = np.abs(run.q - planned[:, 1:])
    if error.max() > LARGEST_ERROR:
        sample, joint = np.unravel_index(int(np.argmax(error > LARGEST_ERROR)), error.shape)
        raise ExoidError(
            f"{plant.leg.joint_names[joint]} is {LARGEST_ERROR:g} rad off its reference at {run.time[sample]:.3g} s",
            remedy="take smaller or slower motions; in walking, another norm, period or scale",
        )
    return run
