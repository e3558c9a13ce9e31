"""Controllers of the experiments: from target and measured motion to a command."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from exoid._typing import ArrayLike, FloatArray


class Target(NamedTuple):
    """Reference motion at one time, (n, B) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s].
        a: Accelerations [rad/s²]; None if unknown.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray | None = None


class Reference(Protocol):
    """Reference motion of n joints of B rigs."""

    def at(self, time: float) -> Target:
        """Evaluate the motion.

        Args:
            time: Time [s].

        Returns:
            Target angles, velocities and, where known, accelerations.
        """
        ...


class Controller(Protocol):
    """Control law from target and measurement to the command of the actuators."""

    def command(
        self, target: Target, q: FloatArray, v: FloatArray, interaction: FloatArray | None = None
    ) -> FloatArray:
        """Compute the command.

        Args:
            target: Reference motion at this time.
            q: Measured angles [rad], (n, B).
            v: Measured velocities [rad/s], (n, B).
            interaction: Torque of the wearers on the legs, as sensors in the cuffs measure it [N·m], (n, B); None where
                nobody wears the rig, or it is not sampled.

        Returns:
            Command in the unit of the actuator, (n, B).
        """
        ...


@dataclass(frozen=True)
class ProportionalDerivative(Controller):
    """PD control u = Kp (θ_ref − θ) + Kd (θ̇_ref − θ̇) (doc. 2, eq. (24)), or P control as in both documents.

    Document 2 prints P control with the opposite sign, which is positive feedback.

    Attributes:
        stiffness: Gain Kp in command per radian, a number, (n,) or (n, B).
        damping: Gain Kd in command per radian a second, a number, (n,) or (n, B); 0 for P control.
    """

    stiffness: ArrayLike
    damping: ArrayLike = 0.0

    def command(
        self, target: Target, q: FloatArray, v: FloatArray, interaction: FloatArray | None = None
    ) -> FloatArray:
        """Compute u, see the class."""
        return _gains(self.stiffness) * (target.q - q) + _gains(self.damping) * (target.v - v)


def _gains(value: ArrayLike) -> FloatArray:
    """Shape gains so that they broadcast over joints and rigs."""
    gains = np.asarray(value, dtype=np.float64)
    return gains[:, None] if gains.ndim == 1 else gains
