"""Rigs with smooth Coulomb friction, c tanh(v / smoothing), at joints and at motors that a coupling connects to them.

The scheme is that of :class:`exoid.rig.PlanarStepper`. Friction is linearised about the velocity extrapolated to the
middle of the step and acts as a torque and a damping. Joints never stick, and every step costs the same.

With θ̇_m = A⁻¹ q̇, the friction c tanh(θ̇_m / smoothing) + d θ̇_m of coupled motors acts on the joints as A⁻ᵀ times it,
and their rotors J add A⁻ᵀ J A⁻¹ to the mass matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.actuators import Coupling
from exoid.leg.joint_numbers import for_joints
from exoid.tools.numbers import checked

from .pinocchio_stepper import PinocchioBodies
from .plant import Plant
from .stepper import Equations, PlanarStepper, RigidBodies, Step
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
        steady, slope = linearise(self._ahead, self.smoothing)
        self._steady, self._gain = self.plant.coulomb * steady, self.plant.coulomb * slope
        return self._equations(torque, self.plant.viscous + damping + self._gain, self._steady)

    def solve(self, equations: Equations) -> Step:
        """Advance by dt: solve the linear equations."""
        mean = self.move(self.v + eliminate(*equations))
        return Step(mean, self.dt * (self._steady + self._gain * mean))


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
            values = for_joints(getattr(self, name), len(self.coupling.joints), name)
            object.__setattr__(self, name, checked(values, name, least=0.0))


class CoupledStepper(SmoothStepper):
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
        super().__init__(plant, q, v, dt, smoothing)
        self._axes, self._coulomb, self._viscous = np.eye(plant.n), plant.coulomb, np.zeros((plant.n, 1))
        self._rotors = np.zeros((plant.n, plant.n))
        if motors is not None:
            coupling = motors.coupling.on(plant.leg)
            own = np.zeros((len(coupling.joints), plant.n))
            own[:, [plant.leg.joint_names.index(joint) for joint in coupling.joints]] = coupling.inverse
            self._axes = np.vstack([self._axes, own])  # angles of joints, then motors, per angle of the joints
            self._coulomb, self._viscous = (
                np.concatenate([x, np.asarray(y)[:, None]])
                for x, y in ((self._coulomb, motors.coulomb), (self._viscous, motors.viscous))
            )
            self._rotors = own.T * np.asarray(motors.rotor) @ own
        self._widths = smoothing * np.linalg.norm(self._axes, axis=1, keepdims=True)

    def _rigid_bodies(self) -> RigidBodies:
        return PinocchioBodies(self.plant)

    def equations(self, torque: FloatArray, damping: FloatArray) -> Equations:
        """Compute the equations of the next step, with smooth friction of joints and motors."""
        axes, half = self._axes, 0.5 * self.dt
        steady, slope = linearise(axes @ self._ahead, self._widths)
        self._steady = axes.T @ (self._coulomb * steady)
        self._gain = axes.T * (self._coulomb * slope + self._viscous)[:, 0] @ axes
        M, impulse = self._equations(torque, self.plant.viscous + damping, self._steady)
        return Equations(M + (half * self._gain + self._rotors)[..., None], impulse - self.dt * self._gain @ self.v)

    def solve(self, equations: Equations) -> Step:
        """Advance by dt: solve the linear equations; the impulse is that of joints and motors."""
        mean = self.move(self.v + eliminate(*equations))
        return Step(mean, self.dt * (self._steady + self._gain @ mean))

    def energy(self) -> FloatArray:
        """Compute the mechanical energy, springs and all rotors included."""
        return np.asarray(super().energy() + 0.5 * np.einsum("ib,ij,jb->b", self.v, self._rotors, self.v))


def linearise(v: FloatArray, smoothing: float | FloatArray) -> tuple[FloatArray, FloatArray]:
    """Linearise tanh(v / smoothing) about v: its value at v = 0, and its slope."""
    sign = np.tanh(v / smoothing)
    slope = (1.0 - sign * sign) / smoothing
    return sign - slope * v, slope
