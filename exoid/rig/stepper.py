"""Integration step of many rigs at once, of planar legs with the closed-form dynamics, or of one rig of any leg.

The scheme is of second order in the step dt. Rigid bodies and springs are evaluated at the middle of the step,
q + ½ dt v, with the velocity extrapolated from the previous step. Viscous friction and actuator damping act on the mean
velocity v̄ = ½ (v + v⁺):

    (M + Ia)(v⁺ − v) = dt [τ₀ − D v̄ − h − k(q)] − r,      q⁺ = q + dt v̄,

with the impulse r of friction and end stops from :mod:`exoid.rig.stick_slip`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .pinocchio_bodies import PinocchioBodies
from .planar_bodies import PlanarBodies
from .plant import Plant
from .stick_slip import Friction, solve_stick_slip


class Step(NamedTuple):
    """Result of one step, (n, B) each."""

    mean_velocity: FloatArray  # mean velocity v̄ [rad/s]; v̄ dt is the change of angle
    friction_impulse: FloatArray  # impulse r of friction and end stops [N·m·s]


class Equations(NamedTuple):
    """Equations of one step: M (v⁺ − v) = impulse − r, with the impulse r of dry friction and end stops."""

    M: FloatArray  # mass matrices with rotors and half the damping of a step on their diagonals [kg·m²], (n, n, B)
    impulse: FloatArray  # impulse of all other torques [N·m·s], (n, B)


def rigid_bodies(plant: Plant) -> PinocchioBodies | PlanarBodies:
    """Choose the closed form for planar legs in a batch, and Pinocchio, which is faster there, for a single rig."""
    if plant.count == 1 or plant.leg.chain is None:
        return PinocchioBodies(plant)
    return PlanarBodies.from_parameters(plant.leg, plant.parameters, plant.pitch)


class Stepper:
    """B planar rigs in one batch of array operations, or one rig of any leg with Pinocchio's dynamics.

    A step has two parts, so that another body may be coupled to the leg in between: the equations, then `solve` or
    `move`, once.

    Args:
        plant: B rigs.
        q: Initial angles [rad], (n, B).
        v: Initial velocities [rad/s], (n, B).
        dt: Step [s].

    Raises:
        ExoidError: There are several rigs of a leg that is not a planar chain.
    """

    def __init__(self, plant: Plant, q: FloatArray, v: FloatArray, dt: float) -> None:
        self.plant, self.dt = plant, dt
        self.q, self.v = np.array(q, dtype=np.float64), np.array(v, dtype=np.float64)
        self._ahead = self.v  # velocity expected in the middle of the next step
        self._middle = self.q  # angles in the middle of the step that the equations are for
        self._bodies = rigid_bodies(plant)
        self._friction = Friction(dt * plant.coulomb, -dt * plant.static, dt * plant.static, stops=False)
        self._stops = bool(np.isfinite(plant.lower).any() or np.isfinite(plant.upper).any())

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """Advance by dt under an actuator torque τ₀ − damping · v̄, with friction and end stops.

        Args:
            torque: Torque τ₀ [N·m], (n, B).
            damping: Damping of the actuators [N·m·s/rad], (n, B).

        Returns:
            Mean velocity, and impulse of friction and end stops.
        """
        return self.solve(self.equations(torque, damping))

    def equations(self, torque: FloatArray, damping: FloatArray) -> Equations:
        """Compute the equations of the next step.

        Args:
            torque: Torque τ₀ [N·m], (n, B).
            damping: Damping of the actuators [N·m·s/rad], (n, B).

        Returns:
            Inertia and impulse of the step.
        """
        plant, damping = self.plant, self.plant.viscous + damping
        q = self._middle = self.q + 0.5 * self.dt * self.v
        b2, b1, b0 = plant.stiffness
        M, force = self._bodies.dynamics(q, self._ahead)
        force += (b2 * q + b1) * q + b0
        force += damping * self.v
        np.subtract(torque, force, out=force)
        diagonal = M.reshape(-1, plant.count)[:: plant.n + 1]
        diagonal += plant.armature + 0.5 * self.dt * damping
        return Equations(M, self.dt * force)

    def solve(self, equations: Equations) -> Step:
        """Advance by dt with stick-slip friction and end stops.

        Args:
            equations: Those of this step.

        Returns:
            Mean velocity, and impulse of friction and end stops.
        """
        v, impulse = solve_stick_slip(*equations, self._with_stops(), self.v)
        return Step(self.move(v), impulse)

    def move(self, v: FloatArray) -> FloatArray:
        """Advance by dt to known velocities.

        Args:
            v: Velocities at the end of the step [rad/s], (n, B).

        Returns:
            Mean velocity [rad/s], (n, B).
        """
        mean = 0.5 * (self.v + v)
        self.v, self._ahead = v, 2.0 * v - mean
        self.q = self.q + self.dt * mean
        return mean

    def energy(self) -> FloatArray:
        """Compute the mechanical energy, springs and rotors included.

        Returns:
            Energy [J], (B,).
        """
        rotors = 0.5 * (self.plant.armature * self.v**2).sum(axis=0)
        (b2, b1, b0), q = self.plant.stiffness, self.q
        springs = (((b2 / 3.0 * q + b1 / 2.0) * q + b0) * q).sum(axis=0)
        return np.asarray(self._bodies.energy(q, self.v) + rotors + springs)

    def _with_stops(self) -> Friction:
        if not self._stops:
            return self._friction
        q = self._middle
        at_lower, at_upper = q <= self.plant.lower, q >= self.plant.upper
        if not (at_lower.any() or at_upper.any()):
            return self._friction
        kinetic, low, high, _ = self._friction
        return Friction(kinetic, np.where(at_lower, -np.inf, low), np.where(at_upper, np.inf, high))
