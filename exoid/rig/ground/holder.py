"""Spring and damper between the torso and a moving carriage: hand rail, harness."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .engine import Engine, quaternion
from .motion import JointTargets, Spring


class Holder:
    """Spring of a run; `wrench` is its force [N] and moment about the point [N·m] on the torso in the last step."""

    def __init__(self, engine: Engine, spring: Spring, targets: JointTargets) -> None:
        plane, self._point = engine.plant.plane, np.array(spring.point)
        axes = np.array([plane.forward, plane.lateral, plane.up])
        self.spring, self._engine, self.wrench = spring, engine, np.zeros((2, 3))
        self._stiffness, self._damping = (axes.T @ np.diag(x) @ axes for x in (spring.stiffness, spring.damping))
        base, rate = targets.base, targets.base_rate
        turned = scipy.spatial.transform.Rotation.from_rotvec(np.outer(base[:, 2], -plane.lateral)).apply(self._point)
        self._turning = np.outer(rate[:, 2], -plane.lateral)
        self._place = base[:, :2] @ axes[[0, 2]] + turned
        self._speed = rate[:, :2] @ axes[[0, 2]] + np.cross(self._turning, turned)
        self._pitch = base[:, 2]

    def force(self, step: int) -> FloatArray:
        """Compute the force in a step."""
        engine, spring = self._engine, self.spring
        position, rotation = engine.torso
        twist, arm = engine.twist(), rotation @ self._point
        force = self._stiffness @ (self._place[step] - position - arm)
        force += self._damping @ (self._speed[step] - twist[3:] - np.cross(twist[:3], arm))
        target = quaternion(-engine.plant.plane.lateral, self._pitch[step])
        moment = spring.turning_stiffness * engine.turn_to(target)
        moment += spring.turning_damping * (self._turning[step] - twist[:3])
        self.wrench = np.array([force, moment])
        return engine.push(force, moment, position + arm)
