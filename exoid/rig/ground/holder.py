"""Spring and damper between the torso and a moving carriage: hand rail, harness."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .engine import Engine, quaternion
from .motion import JointTargets, Spring


class Holder:
    """Spring of a run.

    Args:
        engine: The machine.
        spring: Its constants.
        targets: Motion of the carriage at each step.

    Attributes:
        spring: Its constants.
        last: Generalised force of the last step, (base + n,).
        wrench: Force [N] and moment about the point [N·m] on the torso in the laboratory, of the last step, (2, 3).
    """

    def __init__(self, engine: Engine, spring: Spring, targets: JointTargets) -> None:
        plane, point = engine.plant.plane, np.array(spring.point)
        axes = np.array([plane.forward, plane.lateral, plane.up])
        self.spring, self._engine, self._point = spring, engine, point
        self._stiffness = axes.T @ np.diag(spring.stiffness) @ axes
        self._damping = axes.T @ np.diag(spring.damping) @ axes
        pitch = targets.base[:, 2:]
        arm = point - np.outer(*(2 * [plane.lateral])) @ point  # the part that the pitch turns
        across = np.cross(-plane.lateral, arm)
        turned = np.cos(pitch) * arm + np.sin(pitch) * across
        moved = np.cos(pitch) * across - np.sin(pitch) * arm
        origin, rate = (x[:, :1] * plane.forward + x[:, 1:2] * plane.up for x in (targets.base, targets.base_rate))
        self._place = origin + turned + (point - arm)
        self._speed = rate + targets.base_rate[:, 2:] * moved
        self._pitch, self._turning = pitch[:, 0], -targets.base_rate[:, 2:] * plane.lateral
        self.last, self.wrench = np.zeros(len(engine.rate)), np.zeros((2, 3))

    def force(self, step: int) -> FloatArray:
        """Compute the force in a step.

        Args:
            step: Number of the step.

        Returns:
            Generalised force, (base + n,).
        """
        engine, spring = self._engine, self.spring
        position, rotation = engine.torso
        twist, arm = engine.twist(), rotation @ self._point
        place = position + arm
        force = self._stiffness @ (self._place[step] - place)
        force += self._damping @ (self._speed[step] - twist[3:] - np.cross(twist[:3], arm))
        moment = np.zeros(3)
        if spring.turning_stiffness or spring.turning_damping:
            target = quaternion(-engine.plant.plane.lateral, self._pitch[step])
            moment = spring.turning_stiffness * engine.turn_to(target)
            moment += spring.turning_damping * (self._turning[step] - twist[:3])
        if engine.plant.is_planar:  # the bearings of the plane bear the rest
            lateral = engine.plant.plane.lateral
            force, moment = force - lateral * (lateral @ force), lateral * (lateral @ moment)
        self.wrench = np.array([force, moment])
        self.last = engine.push(force, moment, place)
        return self.last
