"""Actuators: what a controller's command does to a joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError


class Drive(NamedTuple):
    """Torque of an actuator during a step, τ₀ − damping · v̄, (n, B) each.

    Attributes:
        torque: τ₀ [N·m].
        damping: [N·m·s/rad].
    """

    torque: FloatArray
    damping: FloatArray


class Actuator(Protocol):
    """From a command, constant over a step, to a torque; its inner state is an array (n, B)."""

    def drive(self, state: FloatArray, command: FloatArray, dt: float) -> Drive:
        """Torque during the next step."""
        ...

    def advance(self, state: FloatArray, command: FloatArray, mean_velocity: FloatArray, dt: float) -> FloatArray:
        """State after the step."""
        ...

    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """Torque at this moment [N·m], (n, B), as a sensor sees it."""
        ...


@dataclass(frozen=True)
class IdealTorque:
    """Torque follows the command [N·m] at once.

    Attributes:
        limit: Largest torque [N·m].

    Raises:
        ExoidError: The limit is not positive.
    """

    limit: float = np.inf

    def __post_init__(self) -> None:
        """Check the limit."""
        _refuse_unless(self.limit > 0.0, self)

    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """The command, limited."""
        return np.clip(command, -self.limit, self.limit)

    def drive(self, state: FloatArray, command: FloatArray, dt: float) -> Drive:
        """The same throughout the step."""
        return Drive(self.torque(state, command), np.zeros_like(command))

    def advance(self, state: FloatArray, command: FloatArray, mean_velocity: FloatArray, dt: float) -> FloatArray:
        """It has no state."""
        return state


@dataclass(frozen=True)
class DcMotor:
    """Motor behind a gear, commanded by current [A]: τ = ratio · kt · i, as document 2 computes its torque.

    The rotor belongs to the plant: add :attr:`armature` to the joint's ``Ia``.

    Attributes:
        torque_constant: kt [N·m/A], positive.
        ratio: Of the gear.
        rotor_inertia: [kg·m²].
        current_limit: [A].

    Raises:
        ExoidError: A constant is not positive (the rotor's inertia: negative) or not finite (but for the limit).
    """

    torque_constant: float
    ratio: float
    rotor_inertia: float = 0.0
    current_limit: float = np.inf

    def __post_init__(self) -> None:
        """Check the constants."""
        positive = 0.0 < self.torque_constant < np.inf and 0.0 < self.ratio < np.inf and self.current_limit > 0.0
        _refuse_unless(positive and 0.0 <= self.rotor_inertia < np.inf, self)

    @property
    def armature(self) -> float:
        """Rotor inertia seen at the joint, ratio² times the rotor's [kg·m²]."""
        return self.ratio**2 * self.rotor_inertia

    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """Torque of the limited current."""
        return self.ratio * self.torque_constant * np.clip(command, -self.current_limit, self.current_limit)

    def drive(self, state: FloatArray, command: FloatArray, dt: float) -> Drive:
        """The same throughout the step."""
        return Drive(self.torque(state, command), np.zeros_like(command))

    def advance(self, state: FloatArray, command: FloatArray, mean_velocity: FloatArray, dt: float) -> FloatArray:
        """It has no state."""
        return state


@dataclass(frozen=True)
class HydraulicServo:
    """Linearised valve and piston, A' = kh (Kv u − cl A − v): flow by the valve less leakage and motion, compressed.

    Under P control u = Kp (θ_d − θ) the joint follows with bandwidth Kv Kp [1/s] and static stiffness Kv Kp / cl. It is
    stable only if leakage is fast enough, kh cl > Kv Kp; without leakage it is unstable for every gain. Integrated by
    the trapezoidal rule together with the joint.

    Attributes:
        stiffness: kh, of the enclosed oil at the joint [N·m/rad], a number or (n, 1).
        leakage: cl [rad/s/(N·m)], likewise.
        valve_gain: Kv, joint velocity per command [rad/s/V], a number or (n, 1).

    Raises:
        ExoidError: A constant is not finite, stiffness or valve gain not positive, or leakage negative.
    """

    stiffness: ArrayLike = 5000.0
    leakage: ArrayLike = 0.01
    valve_gain: ArrayLike = 1.0

    def __post_init__(self) -> None:
        """Check the constants."""
        kh, cl, Kv = (np.asarray(x, dtype=np.float64) for x in (self.stiffness, self.leakage, self.valve_gain))
        finite = all(np.isfinite(x).all() for x in (kh, cl, Kv))
        _refuse_unless(bool(finite and (kh > 0.0).all() and (cl >= 0.0).all() and (Kv > 0.0).all()), self)

    def torque(self, state: FloatArray, command: FloatArray) -> FloatArray:
        """The state A."""
        return state

    def drive(self, state: FloatArray, command: FloatArray, dt: float) -> Drive:
        """Mean torque ½ (A + A⁺) as a function of the mean velocity."""
        half = 0.5 * dt * np.asarray(self.stiffness)
        scale = 1.0 / (1.0 + half * np.asarray(self.leakage))
        torque = scale * (state + half * np.asarray(self.valve_gain) * command)
        return Drive(torque, np.broadcast_to(scale * half, command.shape))

    def advance(self, state: FloatArray, command: FloatArray, mean_velocity: FloatArray, dt: float) -> FloatArray:
        """Torque A at the end of the step."""
        torque, damping = self.drive(state, command, dt)
        return 2.0 * (torque - damping * mean_velocity) - state


def _refuse_unless(sound: bool, actuator: Actuator) -> None:
    if not sound:
        raise ExoidError(f"no such actuator: {actuator}", remedy="its constants are finite and positive")
