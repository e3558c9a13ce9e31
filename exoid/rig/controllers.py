"""Controllers of the experiments: what the rig is commanded to do about its tracking error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from exoid._typing import ArrayLike, FloatArray


class Target(NamedTuple):
    """Where the joints should be, (n, B) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s].
        a: Accelerations [rad/s²]; None where they are not known.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray | None = None


class Reference(Protocol):
    """A motion to follow."""

    def at(self, time: float) -> Target:
        """Target at a time [s]."""
        ...


class Controller(Protocol):
    """From a target and what the sensors say to a command for the actuators."""

    def command(self, target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
        """Command, (n, B), from measured angles [rad] and velocities [rad/s]."""
        ...


@dataclass(frozen=True)
class Proportional:
    """u = K (θ_ref − θ), as both documents use it; document 2 prints the opposite sign, which is positive feedback.

    Attributes:
        gain: K, in command per radian, a number, (n,) or (n, B).
    """

    gain: ArrayLike

    def command(self, target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
        """See the class."""
        return _gains(self.gain) * (target.q - q)


@dataclass(frozen=True)
class ProportionalDerivative:
    """u = Kp (θ_ref − θ) + Kd (θ̇_ref − θ̇) (doc. 2, eq. (24)).

    Attributes:
        stiffness: Kp, in command per radian, a number, (n,) or (n, B).
        damping: Kd, in command per radian a second, likewise.
    """

    stiffness: ArrayLike
    damping: ArrayLike

    def command(self, target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
        """See the class."""
        return _gains(self.stiffness) * (target.q - q) + _gains(self.damping) * (target.v - v)


def _gains(value: ArrayLike) -> FloatArray:
    """Gains as an array that spreads over joints and rigs."""
    gains = np.asarray(value, dtype=np.float64)
    return gains[:, None] if gains.ndim == 1 else gains
