"""Actuators: from the command of a controller to the torque at a joint."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.tools.numbers import checked


class StepTorque(NamedTuple):
    """Torque of an actuator during a step, τ₀ − damping · v̄, (n, B) each.

    Attributes:
        torque: Torque τ₀ at zero velocity [N·m].
        damping: Damping against the mean velocity v̄ of the step [N·m·s/rad].
    """

    torque: FloatArray
    damping: FloatArray


class Actuator(ABC):
    """Actuators of B rigs: a command, constant during a step, becomes torque.

    The internal state is an array (n, B). An actuator that has none only defines :meth:`torque`.
    """

    @abstractmethod
    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """Compute the torque at this instant, which a torque sensor measures.

        Args:
            state: Internal state, (n, B).
            command: Command, (n, B).

        Returns:
            Torque [N·m], (n, B).
        """

    def drive(self, state: FloatArray, command: FloatArray, dt: float) -> StepTorque:
        """Compute the torque during the next step.

        Args:
            state: Internal state, (n, B).
            command: Command, (n, B).
            dt: Step [s].

        Returns:
            Torque as a linear function of the mean velocity.
        """
        return StepTorque(self.torque(state, command), np.zeros_like(command))

    def advance(self, state: FloatArray, command: FloatArray, mean_velocity: FloatArray, dt: float) -> FloatArray:
        """Compute the internal state after the step.

        Args:
            state: Internal state before, (n, B).
            command: Command, (n, B).
            mean_velocity: Mean velocity of the step [rad/s], (n, B).
            dt: Step [s].

        Returns:
            Internal state after, (n, B).
        """
        return state


@dataclass(frozen=True)
class IdealTorque(Actuator):
    """Torque source: the torque is the command [N·m], limited.

    Attributes:
        limit: Largest torque [N·m].

    Raises:
        ExoidError: The limit is not positive.
    """

    limit: float = np.inf

    def __post_init__(self) -> None:
        """Check the limit."""
        checked(self.limit, "the limit of the torque", above=0.0, infinite=True)

    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """Limit the command [N·m]."""
        return np.clip(command, -self.limit, self.limit)


@dataclass(frozen=True)
class HydraulicServo(Actuator):
    """Linearised valve and cylinder with the torque A as state: Ȧ = kh (Kv u − cl A − v).

    Flow through the valve, less leakage and joint motion, compresses the oil. Under P control u = Kp (θ_d − θ) the
    joint follows with bandwidth Kv Kp [1/s] and static stiffness Kv Kp / cl. The loop is stable only if
    kh cl > Kv Kp, and without leakage it is unstable for every gain. The trapezoidal rule integrates the state
    together with the joint.

    Attributes:
        stiffness: Stiffness kh of the enclosed oil at the joint [N·m/rad], a number or (n, 1).
        leakage: Leakage cl [rad/s/(N·m)], a number or (n, 1).
        valve_gain: Joint velocity per command Kv [rad/s/V], a number or (n, 1).

    Raises:
        ExoidError: A constant is not finite, stiffness or valve gain is not positive, or leakage is negative.
    """

    stiffness: ArrayLike = 5000.0
    leakage: ArrayLike = 0.01
    valve_gain: ArrayLike = 1.0

    def __post_init__(self) -> None:
        """Check the constants."""
        checked(self.stiffness, "stiffness", above=0.0, ndim=2)
        checked(self.valve_gain, "valve_gain", above=0.0, ndim=2)
        checked(self.leakage, "leakage", least=0.0, ndim=2)

    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """Return the state, which is the torque."""
        return state

    def drive(self, state: FloatArray, command: FloatArray, dt: float) -> StepTorque:
        """Compute the mean torque ½ (A + A⁺) as a function of the mean velocity."""
        half = 0.5 * dt * np.asarray(self.stiffness)
        scale = 1.0 / (1.0 + half * np.asarray(self.leakage))
        torque = scale * (state + half * np.asarray(self.valve_gain) * command)
        return StepTorque(torque, np.broadcast_to(scale * half, command.shape))

    def advance(self, state: FloatArray, command: FloatArray, mean_velocity: FloatArray, dt: float) -> FloatArray:
        """Compute the torque A⁺ at the end of the step."""
        torque, damping = self.drive(state, command, dt)
        return 2.0 * (torque - damping * mean_velocity) - state
