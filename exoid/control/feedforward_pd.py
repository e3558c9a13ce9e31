"""PD control with feedforward of the full inverse dynamics of the reference."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .estimate_checks import model_to_compensate
from .friction import AHEAD, FrictionCompensation, with_friction
from .law import RATE, State, acceleration, gains
from .model import ControlModel, ModelSource
from .pd import PD


@dataclass(frozen=True, eq=False)
class FeedforwardPD:
    """τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) + M(θ_d) θ̈_d + C(θ_d, θ̇_d) θ̇_d + G(θ_d) + F_r."""

    # The feedforward depends on the reference alone: noise and delay of the sensors do not affect it.

    feedback: PD  # PD feedback
    model: ControlModel  # model of the feedforward
    friction: FrictionCompensation | None = AHEAD  # friction compensation; None for none

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.feedback.rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        ahead = self.model.inverse_dynamics(target.q, target.v, acceleration(target))
        torque = self.feedback.torque(state, target) + ahead
        return with_friction(torque, self.friction, self.model, state, target)


def feedforward_pd(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> FeedforwardPD:
    """Make a :class:`FeedforwardPD` controller from a model of the leg.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
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
    return FeedforwardPD(PD(gains(kp, "kp"), gains(kd, "kd"), rate), model, friction)
