"""Planned motions on the virtual rig with ground."""

from __future__ import annotations

import numpy as np

from exoid.experiments.ground.planned_motion import Bearing, follow, knots, planned_motion
from exoid.experiments.ground.stance import GAINS, HAND_RAIL
from exoid.rig.ground import GroundPlant, GroundRun, Spring

from .plan import StancePlan


def run_stance(
    plan: StancePlan, plant: GroundPlant | None = None, *, hand_rail: Spring | None = HAND_RAIL
) -> tuple[GroundRun, ...]:
    """Let a machine follow a plan.

    Args:
        plan: The plan.
        plant: Machine with its true parameters; None for that of the plan, without friction.
        hand_rail: What holds the torso while not all feet stand; None for nothing. Its force is logged.

    Returns:
        A run for each motion.

    Raises:
        ExoidError: MuJoCo is not installed, or the machine falls.
    """
    runs = []
    for support, motion in zip(plan.supports, plan.motions, strict=True):
        body, time = plant or support.plant, knots(motion.duration)
        joints = support.joints(motion.at(np.maximum(time, 0.0)))  # at rest until the log begins
        feet = {foot: Bearing(np.ones_like(time), body.soles[foot].centre) for foot in support.feet}
        reference = planned_motion(body, time, joints.q, support.torso(joints).pose, feet)
        runs.append(follow(body, reference, GAINS, spring=hand_rail if support.swings else None))
    return tuple(runs)
