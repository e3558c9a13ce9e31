"""Computed torque: the model turns the leg into double integrators."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .estimate_checks import model_to_compensate
from .friction import AHEAD, FrictionCompensation
from .law import RATE, State, acceleration, gains, refuse_rate, spread
from .model import ControlModel, ModelSource


@dataclass(frozen=True, eq=False)
class ComputedTorque:
    """τ = M(θ) [θ̈_d + kd (θ̇_d − θ̇) + kp (θ_d − θ)] + C(θ, θ̇) θ̇ + G(θ) + F_r.

    With an exact model and in continuous time the error obeys ë + kd ė + kp e = 0, joint by joint.

    Attributes:
        kp: kp [1/s²], a number, (n,) or (n, B); the stiffness is M kp.
        kd: kd [1/s], likewise.
        model: The model.
        friction: How friction is compensated; None for not at all.
        rate: [Hz].
    """

    kp: FloatArray
    kd: FloatArray
    model: ControlModel
    friction: FrictionCompensation | None = AHEAD
    rate: float = RATE

    def __post_init__(self) -> None:
        """Check gains and rate."""
        refuse_rate(self.rate)
        object.__setattr__(self, "kp", gains(self.kp, "kp"))
        object.__setattr__(self, "kd", gains(self.kd, "kd"))

    def torque(self, state: State, target: Target) -> FloatArray:
        """See the class.

        Raises:
            ExoidError: The target has no acceleration.
        """
        q, v = state.q, state.v
        wanted = acceleration(target) + spread(self.kd, v) * (target.v - v) + spread(self.kp, q) * (target.q - q)
        torque = self.model.inverse_dynamics(q, v, wanted)
        return torque if self.friction is None else torque + self.friction.torque(self.model, state, target)


def computed_torque(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> ComputedTorque:
    """Make a :class:`ComputedTorque` law from what is known of the leg.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        kp: kp [1/s²], the square of the wanted natural frequency.
        kd: kd [1/s], twice the natural frequency for critical damping.
        friction: How friction is compensated; None for not at all.
        rate: At which it is sampled [Hz].

    Raises:
        ExoidError: A gain is negative, or there is no model to be had from the source.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    model = model_to_compensate(source, friction)
    return ComputedTorque(gains(kp, "kp"), gains(kd, "kd"), model, friction, rate)
