"""Rigs with smooth Coulomb friction, c tanh(v / smoothing), at joints and at motors that a coupling connects to them.

The scheme is that of :class:`exoid.rig.Stepper`. Friction is linearised about the velocity extrapolated to the
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
from exoid.rig import Plant, Stepper
from exoid.rig.stepper import Equations, Step
from exoid.rig.stick_slip import eliminate
from exoid.tools.numbers import checked


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


class SmoothStepper(Stepper):
    """Rigs without sticking and without end stops, with coupled motors if there are any.

    Args:
        plant: B rigs; ``static`` friction, ``lower`` and ``upper`` have no effect.
        q: Initial angles [rad], (n, B).
        v: Initial velocities [rad/s], (n, B).
        dt: Step [s].
        smoothing: Velocity scale of the sign change of friction at a joint [rad/s]; that of a motor is larger by its
            ratio, the length of its row of A⁻¹.
        motors: Coupled motors of every rig; None for none.

    Raises:
        ExoidError: There are several rigs of a leg that is not a planar chain, or the plant lacks a joint of the
            coupling.

    Example:
        >>> from functools import partial
        >>> motors = CoupledMotors(Coupling(("hip", "knee"), ((1.0, 0.0), (1.0, 1.0))), coulomb=0.2)
        >>> stepper = partial(SmoothStepper, motors=motors)  # for simulate(..., stepper=stepper)
    """

    def __init__(
        self,
        plant: Plant,
        q: FloatArray,
        v: FloatArray,
        dt: float,
        smoothing: float = 0.02,
        motors: CoupledMotors | None = None,
    ) -> None:
        super().__init__(plant, q, v, dt)
        self.smoothing = smoothing
        self._axes = np.zeros((0, plant.n))  # rows of A⁻¹: angles of motors per angle of the joints
        self._coulomb = self._viscous = np.zeros((0, 1))  # of the motors
        self._rotors = np.zeros((plant.n, plant.n))  # A⁻ᵀ J A⁻¹
        if motors is not None:
            coupling = motors.coupling.on(plant.leg)
            self._axes = np.zeros((len(coupling.joints), plant.n))
            self._axes[:, [plant.leg.joint_names.index(joint) for joint in coupling.joints]] = coupling.inverse
            self._coulomb, self._viscous = (np.asarray(x)[:, None] for x in (motors.coulomb, motors.viscous))
            self._rotors = self._axes.T * np.asarray(motors.rotor) @ self._axes
        self._widths = smoothing * np.linalg.norm(self._axes, axis=1, keepdims=True)
        self._steady = self._gain = np.zeros_like(self.q)  # torque of friction: steady + gain v̄ + coupled v̄
        self._coupled = np.zeros((plant.n, plant.n, plant.count))

    def equations(self, torque: FloatArray, damping: FloatArray) -> Equations:
        """Compute the equations of the next step, with smooth friction of joints and motors."""
        axes, c = self._axes, self.plant.coulomb
        steady, slope = linearise(self._ahead, self.smoothing)
        of_motors, their_slope = linearise(axes @ self._ahead, self._widths)
        self._steady, self._gain = c * steady + axes.T @ (self._coulomb * of_motors), c * slope
        self._coupled = np.einsum("mi,mb,mj->ijb", axes, self._coulomb * their_slope + self._viscous, axes)
        M, impulse = super().equations(torque - self._steady, damping + self._gain)
        M += 0.5 * self.dt * self._coupled + self._rotors[..., None]
        return Equations(M, impulse - self.dt * (self._coupled * self.v).sum(axis=1))

    def solve(self, equations: Equations) -> Step:
        """Advance by dt: solve the linear equations; the impulse is that of joints and motors."""
        mean = self.move(self.v + eliminate(*equations))
        friction = self._steady + self._gain * mean + (self._coupled * mean).sum(axis=1)
        return Step(mean, self.dt * friction)

    def energy(self) -> FloatArray:
        """Compute the mechanical energy, springs and all rotors included."""
        return np.asarray(super().energy() + 0.5 * np.einsum("ib,ij,jb->b", self.v, self._rotors, self.v))


def linearise(v: FloatArray, smoothing: float | FloatArray) -> tuple[FloatArray, FloatArray]:
    """Linearise tanh(v / smoothing) about v: its value at v = 0, and its slope."""
    sign = np.tanh(v / smoothing)
    slope = (1.0 - sign * sign) / smoothing
    return sign - slope * v, slope
