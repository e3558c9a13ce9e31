"""Spring and damper between the torso and a moving carriage: hand rail, harness."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .engine import Engine, quaternion
from .motion import JointTargets, Spring


class Holder(Protocol):
    """Spring of a run."""

    @property
    def spring(self) -> Spring:
        """Constants of the spring."""
        ...

    @property
    def wrench(self) -> FloatArray:
        """Force [N] and moment about the point [N·m] on the torso in the laboratory, of the last step, (2, 3)."""
        ...

    def force(self, step: int) -> FloatArray:
        """Compute the force in a step."""
        ...


def hold(engine: Engine, spring: Spring, targets: JointTargets) -> Holder:
    """Attach a spring to the torso."""
    return (PlanarHolder if engine.plant.is_planar else SpatialHolder)(engine, spring, targets)


class PlanarHolder:
    """Spring in the plane, in plain floats, where a vector (forward, up) is the complex number x + i z."""

    def __init__(self, engine: Engine, spring: Spring, targets: JointTargets) -> None:
        plane = engine.plant.plane
        self.spring, self._engine, self._plane = spring, engine, plane
        self._point = complex(np.array(spring.point) @ (plane.forward + 1j * plane.up))
        base, rate = targets.base, targets.base_rate
        turned = np.exp(1j * base[:, 2]) * self._point
        self._place = (base[:, 0] + 1j * base[:, 1] + turned).tolist()
        self._speed = (rate[:, 0] + 1j * rate[:, 1] + 1j * rate[:, 2] * turned).tolist()
        self._pitch, self._pitching = base[:, 2].tolist(), rate[:, 2].tolist()
        self._last, self._out = (0.0, 0.0, 0.0), np.zeros(len(engine.rate))

    def force(self, step: int) -> FloatArray:
        """Compute the force in a step."""
        spring = self.spring
        x, z, pitch = self._engine.data.qpos[:3].tolist()
        vx, vz, rate = self._engine.rate[:3].tolist()
        arm = self._point * complex(np.cos(pitch), np.sin(pitch))
        off = self._place[step] - complex(x, z) - arm
        slow = self._speed[step] - complex(vx, vz) - 1j * rate * arm
        fx = spring.stiffness[0] * off.real + spring.damping[0] * slow.real
        fz = spring.stiffness[2] * off.imag + spring.damping[2] * slow.imag
        moment = spring.turning_stiffness * (self._pitch[step] - pitch)
        moment += spring.turning_damping * (self._pitching[step] - rate)
        self._last = (fx, fz, moment)
        self._out[:3] = fx, fz, moment + arm.real * fz - arm.imag * fx
        return self._out

    @property
    def wrench(self) -> FloatArray:
        """Force [N] and moment about the point [N·m] on the torso in the laboratory, of the last step, (2, 3)."""
        fx, fz, moment = self._last
        return np.array([fx * self._plane.forward + fz * self._plane.up, -moment * self._plane.lateral])


class SpatialHolder:
    """Spring in space."""

    # spring: Constants of the spring.
    # wrench: Force [N] and moment about the point [N·m] on the torso in the laboratory, of the last step, (2,
    # 3).

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
