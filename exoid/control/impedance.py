"""Impedance control: the leg yields to the wearer as a spring and a damper about the target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .law import RATE, State, freeze_gains, gains, refuse_rate, spread
from .model import ControlModel, ModelSource
from .passive_friction import PASSIVE, PassiveFriction, wearer_friction


@dataclass(frozen=True, eq=False)
class Impedance:
    """τ = K (θ_d − θ) + D (θ̇_d − θ̇) + M̂ θ̈_d + Ĉ θ̇ + Ĝ + ŝ + τ_f (Hogan 1985), with the inertia of the leg itself."""

    # With an exact model and e = θ_d − θ the wearer feels τ_wearer = −(M ë + D ė + K e): at rest a spring of
    # stiffness K, whatever the weight. A target without accelerations counts as one of constant velocity.

    stiffness: FloatArray  # stiffness K [N·m/rad], a number, (n,) or (n, B)
    damping: FloatArray  # damping D [N·m·s/rad], likewise
    model: ControlModel  # model of the leg
    friction: PassiveFriction | None = PASSIVE  # friction compensation, which never drives; None for none
    rate: float = RATE  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check stiffness, damping and rate."""
        refuse_rate(self.rate)
        freeze_gains(self, "stiffness", "damping")

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        q, v = state.q, state.v
        a = np.zeros_like(q) if target.a is None else np.broadcast_to(target.a, q.shape)
        spring = spread(self.stiffness, q) * (target.q - q) + spread(self.damping, v) * (target.v - v)
        return spring + self.model.inverse_dynamics(q, v, a) + wearer_friction(self.friction, self.model, q, v)


def impedance(
    source: ModelSource,
    stiffness: ArrayLike,
    damping: ArrayLike,
    *,
    friction: PassiveFriction | None = PASSIVE,
    rate: float = RATE,
) -> Impedance:
    """Make an :class:`Impedance` controller.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        stiffness: Stiffness K [N·m/rad], a number or one for each joint.
        damping: Damping D [N·m·s/rad].
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: Stiffness or damping is negative, or the source has no control model.

    Example:
        >>> law = impedance(est, stiffness=(60.0, 40.0), damping=(6.0, 4.0))  # doctest: +SKIP
    """
    model = ControlModel.of(source)
    return Impedance(gains(stiffness, "stiffness"), gains(damping, "damping"), model, friction, rate)
