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
    """

    q: FloatArray
    v: FloatArray


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
        gain: K, in command per radian, a number or (n,).
    """

    gain: ArrayLike

    def command(self, target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
        """See the class."""
        return np.asarray(self.gain, dtype=np.float64).reshape(-1, 1) * (target.q - q)


@dataclass(frozen=True)
class ProportionalDerivative:
    """u = Kp (θ_ref − θ) + Kd (θ̇_ref − θ̇) (doc. 2, eq. (24)).

    Attributes:
        stiffness: Kp, in command per radian, a number or (n,).
        damping: Kd, in command per radian a second.
    """

    stiffness: ArrayLike
    damping: ArrayLike

    def command(self, target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
        """See the class."""
        kp, kd = (np.asarray(gain, dtype=np.float64).reshape(-1, 1) for gain in (self.stiffness, self.damping))
        return kp * (target.q - q) + kd * (target.v - v)
