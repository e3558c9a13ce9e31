"""Proportional and proportional-derivative control."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .law import RATE, State, freeze_gains, gains, refuse_rate, spread


@dataclass(frozen=True, eq=False)
class PD:
    """τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) (doc. 2, eq. (24))."""

    kp: FloatArray  # gain Kp [N·m/rad], a number, (n,) or (n, B)
    kd: FloatArray  # gain Kd [N·m·s/rad], likewise
    rate: float = RATE  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check gains and rate."""
        refuse_rate(self.rate)
        freeze_gains(self, "kp", "kd")

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        q, v = state.q, state.v
        return spread(self.kp, q) * (target.q - q) + spread(self.kd, v) * (target.v - v)


def pd(kp: ArrayLike, kd: ArrayLike, *, rate: float = RATE) -> PD:
    """Make a :class:`PD` controller, document 2's first one, which needs no model.

    Args:
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        rate: Sampling rate [Hz]; 30 in document 2.

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative or not finite, or the rate is not positive.

    Example:
        >>> import numpy as np
        >>> from exoid.control import State, pd
        >>> from exoid.rig import Target
        >>> law = pd(kp=(22.0, 56.0), kd=(2.2, 5.6))
        >>> law.torque(State(np.zeros(2), np.zeros(2)), Target(np.array([0.1, 0.2]), np.zeros(2)))
        array([ 2.2, 11.2])
    """
    return PD(gains(kp, "kp"), gains(kd, "kd"), rate)


def p(kp: ArrayLike, *, rate: float = RATE) -> PD:
    """Make a :class:`PD` controller without damping, τ = Kp (θ_d − θ) (doc. 2, sec. III, sign corrected).

    Args:
        kp: Kp [N·m/rad], a number or one for each joint.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative or not finite, or the rate is not positive.
    """
    return pd(kp, 0.0, rate=rate)
