"""Rig of one leg whose motors a coupling connects to several joints: friction and rotors of both sides.

The scheme is that of :class:`exoid.rig.SmoothStepper`, with Pinocchio's rigid bodies. With θ̇_m = A⁻¹ q̇, the friction
c tanh(θ̇_m / smoothing) + d θ̇_m of the motors acts on the joints as A⁻ᵀ times it, and their rotors J add A⁻ᵀ J A⁻¹ to
the mass matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from exoid._typing import ArrayLike, FloatArray
from exoid.actuators import Coupling
from exoid.errors import ExoidError
from exoid.leg.model import configuration

from .plant import Plant
from .stepper import Equations, Step, spring_energy


@dataclass(frozen=True)
class CoupledMotors:
    """Motors of a coupling, with friction and rotors of their own.

    Attributes:
        coupling: Coupling of joints of the plant.
        coulomb: Coulomb friction of each motor [N·m], a number or (k,).
        viscous: Viscous friction of each motor [N·m·s/rad].
        rotor: Inertia of each rotor about its own axis [kg·m²].

    Raises:
        ExoidError: A number is negative or not finite, or there are other numbers of them.
    """

    coupling: Coupling
    coulomb: ArrayLike = 0.0
    viscous: ArrayLike = 0.0
    rotor: ArrayLike = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("coulomb", "viscous", "rotor"):
            values = np.asarray(getattr(self, name), dtype=np.float64)
            count = len(self.coupling.joints)
            if values.shape not in ((), (count,)) or not np.isfinite(values).all() or (values < 0.0).any():
                raise ExoidError(f"{name} = {getattr(self, name)!r} of {count} motors", remedy="give numbers ≥ 0")
            object.__setattr__(self, name, np.broadcast_to(values, (count,)))


class CoupledStepper:
    """Single rig of any leg with coupled motors, without sticking and without end stops.

    Args:
        plant: One rig; ``static`` friction, ``lower`` and ``upper`` have no effect.
        q: Initial angles [rad], (n, 1).
        v: Initial velocities [rad/s], (n, 1).
        dt: Step [s].
        motors: The motors; None for none.
        smoothing: Velocity scale of the sign change of friction at a joint [rad/s]; that of a motor is larger by its
            ratio, the length of its row of A⁻¹.

    Raises:
        ExoidError: The plant has more than one rig, or lacks a joint of the coupling.

    Example:
        >>> from functools import partial
        >>> motors = CoupledMotors(Coupling(("hip", "knee"), ((1.0, 0.0), (1.0, 1.0))), coulomb=0.2)
        >>> stepper = partial(CoupledStepper, motors=motors)  # for simulate(..., stepper=stepper)
    """

    def __init__(
        self,
        plant: Plant,
        q: FloatArray,
        v: FloatArray,
        dt: float,
        motors: CoupledMotors | None = None,
        smoothing: float = 0.02,
    ) -> None:
        if plant.count != 1:
            raise ExoidError(f"coupled motors on {plant.count} rigs", remedy="use plant.take([k])")
        self.plant, self.dt = plant, dt
        self.q, self.v = np.array(q, dtype=np.float64), np.array(v, dtype=np.float64)
        self._ahead = self.v[:, 0]
        leg = plant.leg.with_parameters(plant.parameters[:, 0])
        self._model = pin.Model(leg.model)
        self._model.gravity.linear = leg.gravity_of_tilted_torso(float(plant.pitch[0]))
        self._data = self._model.createData()
        self._axes = np.eye(plant.n)  # joints, then motors: angles of each per angle of the joints
        self._coulomb, self._viscous = plant.coulomb[:, 0], plant.viscous[:, 0]
        rotors = plant.armature[:, 0]
        if motors is not None:
            coupling = motors.coupling.on(plant.leg)
            axes = np.zeros((len(coupling.joints), plant.n))
            axes[:, [plant.leg.joint_names.index(joint) for joint in coupling.joints]] = coupling.inverse
            self._axes = np.vstack([self._axes, axes])
            self._coulomb = np.append(self._coulomb, motors.coulomb)
            self._viscous = np.append(self._viscous, motors.viscous)
            rotors = np.append(rotors, motors.rotor)
        self._rotors = self._axes.T * rotors @ self._axes
        self._smoothing = smoothing * np.linalg.norm(self._axes, axis=1)
        self._steady, self._gain = np.zeros(plant.n), np.zeros((plant.n, plant.n))

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """Advance by dt under the actuator torque τ₀ − damping · v̄.

        Args:
            torque: Torque τ₀ [N·m], (n, 1).
            damping: Damping of the actuators [N·m·s/rad], (n, 1).

        Returns:
            Mean velocity and impulse of friction, that of the motors included.
        """
        return self.solve(self.equations(torque, damping))

    def equations(self, torque: FloatArray, damping: FloatArray) -> Equations:
        """Compute the equations of the next step, with smooth friction of joints and motors.

        Args:
            torque: Torque τ₀ [N·m], (n, 1).
            damping: Damping of the actuators [N·m·s/rad], (n, 1).

        Returns:
            Mass matrix and impulse.
        """
        dt, v, axes = self.dt, self.v[:, 0], self._axes
        q = self.q[:, 0] + 0.5 * dt * v
        ahead = axes @ self._ahead
        sign = np.tanh(ahead / self._smoothing)
        slope = self._coulomb * (1.0 - sign * sign) / self._smoothing
        self._steady = axes.T @ (self._coulomb * sign - slope * ahead)
        self._gain = axes.T * (slope + self._viscous) @ axes
        M = self._mass_matrix(q)
        at = configuration(self._model, q[None])[0]
        bias = pin.nonLinearEffects(self._model, self._data, at, self._ahead)
        b2, b1, b0 = self.plant.stiffness[..., 0]
        D = self._gain + np.diag(damping[:, 0])
        force = torque[:, 0] - bias - (b2 * q + b1) * q - b0 - self._steady - D @ v
        return Equations((M + 0.5 * dt * D)[..., None], dt * force[:, None])

    def solve(self, equations: Equations) -> Step:
        """Advance by dt: solve the equations.

        Args:
            equations: Equations of the step.

        Returns:
            Mean velocity and impulse of friction, that of the motors included.
        """
        M, impulse = equations
        mean = self.move(self.v + np.linalg.solve(M[..., 0], impulse))
        of_joints = self.plant.viscous * mean  # the rig counts these itself
        return Step(mean, self.dt * (self._steady[:, None] + self._gain @ mean - of_joints))

    def move(self, v: FloatArray) -> FloatArray:
        """Advance by dt to known velocities.

        Args:
            v: Velocities after the step [rad/s], (n, 1).

        Returns:
            Mean velocity of the step [rad/s], (n, 1).
        """
        mean = 0.5 * (self.v + v)
        self.v, self._ahead = v, (2.0 * v - mean)[:, 0]
        self.q = self.q + self.dt * mean
        return mean

    def energy(self) -> FloatArray:
        """Compute the mechanical energy, springs and rotors included.

        Returns:
            Energy [J], (1,).
        """
        q, v = self.q[:, 0], self.v[:, 0]
        at = configuration(self._model, q[None])[0]
        raised = pin.computePotentialEnergy(self._model, self._data, at)
        return np.asarray(0.5 * v @ self._mass_matrix(q) @ v + raised + spring_energy(self.plant, self.q))

    def _mass_matrix(self, q: FloatArray) -> FloatArray:
        """Mass matrix with all rotors [kg·m²], (n, n)."""
        upper = np.triu(pin.crba(self._model, self._data, configuration(self._model, q[None])[0]))
        return np.asarray(upper + np.triu(upper, 1).T + self._rotors)
