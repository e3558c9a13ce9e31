"""One step of the rigs in time, many at once on the planar closed form.

Second order in the step dt: bodies, springs and gravity are evaluated at the middle of the step, q + ½ dt v with the
velocity extrapolated from the last one; viscous friction and actuator damping act on the mean velocity v̄ = ½ (v + v⁺):

    (M + Ia)(v⁺ − v) = dt [τ₀ − D v̄ − h − k(q)] − r,      q⁺ = q + dt v̄,

with the impulse r of friction and end stops from :mod:`exoid.rig.stick_slip`.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from exoid._typing import FloatArray

from .planar_bodies import PlanarBodies
from .plant import Plant
from .stick_slip import Friction, solve_stick_slip


class Step(NamedTuple):
    """What happened in one step, (n, B) each.

    Attributes:
        mean_velocity: v̄ [rad/s]; times dt it is the angle travelled.
        taken: Impulse r taken by friction and end stops [N·m·s].
    """

    mean_velocity: FloatArray
    taken: FloatArray


class Stepper(Protocol):
    """State of B rigs, and how it goes on."""

    plant: Plant
    dt: float

    @property
    def q(self) -> FloatArray:
        """Angles [rad], (n, B)."""
        ...

    @property
    def v(self) -> FloatArray:
        """Velocities [rad/s], (n, B)."""
        ...

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """Go on by dt under the actuator torque τ₀ − damping · v̄ [N·m], (n, B)."""
        ...

    def energy(self) -> FloatArray:
        """Mechanical energy, springs and rotors included [J], (B,)."""
        ...


class PlanarStepper:
    """B planar rigs side by side, without a loop over rigs."""

    def __init__(self, plant: Plant, q: FloatArray, v: FloatArray, dt: float) -> None:
        self.plant, self.dt = plant, dt
        self.q, self.v = np.array(q, dtype=np.float64), np.array(v, dtype=np.float64)
        self._ahead = self.v  # velocity expected in the middle of the next step
        self._bodies = PlanarBodies.from_parameters(plant.leg, plant.parameters, plant.pitch)
        self._friction = Friction(dt * plant.coulomb, -dt * plant.static, dt * plant.static, stops=False)
        self._stops = bool(np.isfinite(plant.lower).any() or np.isfinite(plant.upper).any())

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """See :class:`Stepper`."""
        plant, dt, last = self.plant, self.dt, self.v
        b2, b1, b0 = plant.stiffness
        q = self.q + 0.5 * dt * last
        M, force = self._bodies.dynamics(q, self._ahead)
        damping = plant.viscous + damping
        force += (b2 * q + b1) * q + b0
        force += damping * last
        np.subtract(torque, force, out=force)
        diagonal = M.reshape(-1, plant.count)[:: plant.n + 1]
        diagonal += plant.armature + 0.5 * dt * damping
        self.v, taken = solve_stick_slip(M, dt * force, self._with_stops(q), last)
        mean = 0.5 * (last + self.v)
        self._ahead = 2.0 * self.v - mean
        self.q = self.q + dt * mean
        return Step(mean, taken)

    def energy(self) -> FloatArray:
        """See :class:`Stepper`."""
        rotors = 0.5 * (self.plant.armature * self.v**2).sum(axis=0)
        return np.asarray(self._bodies.energy(self.q, self.v) + rotors + spring_energy(self.plant, self.q))

    def _with_stops(self, q: FloatArray) -> Friction:
        if not self._stops:
            return self._friction
        at_lower, at_upper = q <= self.plant.lower, q >= self.plant.upper
        if not (at_lower.any() or at_upper.any()):
            return self._friction
        kinetic, low, high, _ = self._friction
        return Friction(kinetic, np.where(at_lower, -np.inf, low), np.where(at_upper, np.inf, high))


def spring_energy(plant: Plant, q: FloatArray) -> FloatArray:
    """Energy of the springs b2 q³/3 + b1 q²/2 + b0 q, summed over joints [J], (B,)."""
    b2, b1, b0 = plant.stiffness
    return np.asarray((((b2 / 3.0 * q + b1 / 2.0) * q + b0) * q).sum(axis=0))
