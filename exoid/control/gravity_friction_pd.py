"""PD control with gravity and friction compensation: document 2's nonlinear controller."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import ArrayLike, FloatArray
from exoid.identification import Estimate
from exoid.leg import Leg
from exoid.rig import Plant, Target

from .friction import SMOOTH, FrictionCompensation
from .law import RATE, State, gains, refuse_rate
from .model import ControlModel
from .pd import PD
from .suspicion import warn_of_active_friction


@dataclass(frozen=True, eq=False)
class GravityFrictionPD:
    """τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) + G(θ) + F_r(θ, θ̇) (doc. 2, eq. (25)).

    Springs and offsets, which depend on the angle as gravity does, are compensated with it.

    Attributes:
        feedback: The PD part.
        model: Whose gravity and friction are compensated.
        friction: How friction is; None for not at all.
    """

    feedback: PD
    model: ControlModel
    friction: FrictionCompensation | None = SMOOTH

    @property
    def rate(self) -> float:
        """At which it is sampled [Hz]."""
        return self.feedback.rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """See the class."""
        torque = self.feedback.torque(state, target) + self.model.statics(state.q)
        return torque if self.friction is None else torque + self.friction.torque(self.model, state, target)


def gravity_friction_pd(
    source: Estimate | Leg | Plant | ControlModel,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = SMOOTH,
    rate: float = RATE,
) -> GravityFrictionPD:
    """Make a :class:`GravityFrictionPD` law from what is known of the leg.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, whose truth is then known.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        friction: How friction is compensated; None for gravity compensation only.
        rate: At which it is sampled [Hz].

    Returns:
        The law.

    Raises:
        ExoidError: A gain is negative, or there is no model to be had from the source.

    Warns:
        UserWarning: The friction coefficients are negative: compensating them destabilises the leg.

    Example:
        >>> law = gravity_friction_pd(est, kp=(22.0, 56.0), kd=(2.2, 5.6))  # doctest: +SKIP
    """
    refuse_rate(rate)
    model = ControlModel.of(source)
    if friction is not None:
        warn_of_active_friction(model)
    return GravityFrictionPD(PD(gains(kp, "kp"), gains(kd, "kd"), rate), model, friction)
