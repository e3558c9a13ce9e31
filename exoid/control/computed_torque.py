"""Computed torque: the model reduces the leg to double integrators."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .estimate_checks import model_to_compensate
from .friction import AHEAD, FrictionCompensation, with_friction
from .law import RATE, State, acceleration, freeze_gains, gains, refuse_rate, spread
from .model import ControlModel, ModelSource


@dataclass(frozen=True, eq=False)
class ComputedTorque:
    """τ = M(θ) [θ̈_d + kd (θ̇_d − θ̇) + kp (θ_d − θ)] + C(θ, θ̇) θ̇ + G(θ) + F_r."""

    # With an exact model and in continuous time the error obeys ë + kd ė + kp e = 0, joint by joint.

    kp: FloatArray  # gain kp [1/s²], a number, (n,) or (n, B); the stiffness is M kp
    kd: FloatArray  # gain kd [1/s], likewise
    model: ControlModel  # model of the leg
    friction: FrictionCompensation | None = AHEAD  # friction compensation; None for none
    rate: float = RATE  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check gains and rate."""
        refuse_rate(self.rate)
        freeze_gains(self, "kp", "kd")

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        q, v = state.q, state.v
        requested = acceleration(target) + spread(self.kd, v) * (target.v - v) + spread(self.kp, q) * (target.q - q)
        torque = self.model.inverse_dynamics(q, v, requested)
        return with_friction(torque, self.friction, self.model, state, target)


def computed_torque(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> ComputedTorque:
    """Make a :class:`ComputedTorque` controller from a model of the leg.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        kp: Gain [1/s²], the square of the natural frequency.
        kd: Gain [1/s], twice the natural frequency for critical damping.
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative, or the source has no control model.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    model = model_to_compensate(source, friction)
    return ComputedTorque(gains(kp, "kp"), gains(kd, "kd"), model, friction, rate)
