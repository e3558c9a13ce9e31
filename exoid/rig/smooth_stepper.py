"""Rigs with smooth Coulomb friction, c tanh(v / smoothing), as in the models that are identified.

The scheme is that of :class:`exoid.rig.PlanarStepper`. Friction is linearised about the velocity extrapolated to the
middle of the step and acts as a torque and a damping. Joints never stick, and every step costs the same.
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .plant import Plant
from .stepper import Equations, PlanarStepper, Step
from .stick_slip import eliminate


class SmoothStepper(PlanarStepper):
    """B planar rigs in one batch, without sticking and without end stops.

    Args:
        plant: B rigs; ``static`` friction, ``lower`` and ``upper`` have no effect.
        q: Initial angles [rad], (n, B).
        v: Initial velocities [rad/s], (n, B).
        dt: Step [s].
        smoothing: Velocity scale of the sign change of friction [rad/s].

    Raises:
        ExoidError: The leg is not a planar chain.
    """

    def __init__(self, plant: Plant, q: FloatArray, v: FloatArray, dt: float, smoothing: float = 0.02) -> None:
        super().__init__(plant, q, v, dt)
        self.smoothing = smoothing
        self._steady = self._gain = np.zeros_like(self.q)  # of the torque of friction, steady + gain v̄

    def equations(self, torque: FloatArray, damping: FloatArray) -> Equations:
        """Compute the equations of the next step, with smooth friction."""
        steady, slope = linearised(self._ahead, self.smoothing)
        self._steady, self._gain = self.plant.coulomb * steady, self.plant.coulomb * slope
        return self._equations(torque, self.plant.viscous + damping + self._gain, self._steady)

    def solve(self, equations: Equations) -> Step:
        """Advance by dt: solve the linear equations."""
        mean = self.move(self.v + eliminate(*equations))
        return Step(mean, self.dt * (self._steady + self._gain * mean))


def linearised(v: FloatArray, smoothing: float | FloatArray) -> tuple[FloatArray, FloatArray]:
    """Linearise tanh(v / smoothing) about v: its value at v = 0, and its slope."""
    sign = np.tanh(v / smoothing)
    slope = (1.0 - sign * sign) / smoothing
    return sign - slope * v, slope
