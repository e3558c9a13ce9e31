"""Rigs whose Coulomb friction has a smooth sign, c tanh(v / smoothing), as models to be identified have it.

The same scheme as :class:`exoid.rig.PlanarStepper`, but friction is a force like any other: linearised about the
velocity expected in the middle of the step, where it acts as a torque and a damping. Nothing sticks, and a step costs
the same whatever the joints do.
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .plant import Plant
from .stepper import PlanarStepper, Step
from .stick_slip import eliminate


class SmoothStepper(PlanarStepper):
    """B planar rigs side by side, without sticking and without end stops.

    Args:
        plant: The truth; of its friction only ``coulomb`` and ``viscous`` act.
        q: Angles to begin with [rad], (n, B).
        v: Velocities to begin with [rad/s], (n, B).
        dt: Step [s].
        smoothing: Velocity over which friction changes its sign [rad/s].
    """

    def __init__(self, plant: Plant, q: FloatArray, v: FloatArray, dt: float, smoothing: float = 0.02) -> None:
        super().__init__(plant, q, v, dt)
        self.smoothing = smoothing

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """See :class:`exoid.rig.Stepper`."""
        plant, dt, last, ahead = self.plant, self.dt, self.v, self._ahead
        b2, b1, b0 = plant.stiffness
        q = self.q + 0.5 * dt * last
        M, force = self._bodies.dynamics(q, ahead)
        sign = np.tanh(ahead / self.smoothing)
        slope = (1.0 - sign * sign) / self.smoothing
        friction, rub = plant.coulomb * (sign - slope * ahead), plant.coulomb * slope  # τ = friction + rub · v̄
        damping = plant.viscous + damping
        force += (b2 * q + b1) * q + b0
        force += friction
        force += (damping + rub) * last
        np.subtract(torque, force, out=force)
        diagonal = M.reshape(-1, plant.count)[:: plant.n + 1]
        diagonal += plant.armature + 0.5 * dt * (damping + rub)
        self.v = last + eliminate(M, dt * force)
        mean = 0.5 * (last + self.v)
        self._ahead = 2.0 * self.v - mean
        self.q = self.q + dt * mean
        return Step(mean, dt * (friction + rub * mean))
