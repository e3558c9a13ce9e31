"""PD control beside the full inverse dynamics of the reference."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .estimate_checks import model_to_compensate
from .friction import AHEAD, FrictionCompensation
from .law import RATE, State, acceleration, gains
from .model import ControlModel, ModelSource
from .pd import PD


@dataclass(frozen=True, eq=False)
class FeedforwardPD:
    """τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) + M(θ_d) θ̈_d + C(θ_d, θ̇_d) θ̇_d + G(θ_d) + F_r.

    What the model knows is known in advance, so that neither noise nor delay of the sensors gets into it.

    Attributes:
        feedback: The PD part.
        model: Whose inverse dynamics is fed forward.
        friction: How friction is compensated; None for not at all.
    """

    feedback: PD
    model: ControlModel
    friction: FrictionCompensation | None = AHEAD

    @property
    def rate(self) -> float:
        """At which it is sampled [Hz]."""
        return self.feedback.rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """See the class.

        Raises:
            ExoidError: The target has no acceleration.
        """
        ahead = self.model.inverse_dynamics(target.q, target.v, acceleration(target))
        torque = self.feedback.torque(state, target) + ahead
        return torque if self.friction is None else torque + self.friction.torque(self.model, state, target)


def feedforward_pd(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> FeedforwardPD:
    """Make a :class:`FeedforwardPD` law from what is known of the leg; arguments as for ``gravity_friction_pd``.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        friction: How friction is compensated; None for not at all.
        rate: At which it is sampled [Hz].

    Raises:
        ExoidError: A gain is negative, or there is no model to be had from the source.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    model = model_to_compensate(source, friction)
    return FeedforwardPD(PD(gains(kp, "kp"), gains(kd, "kd"), rate), model, friction)
