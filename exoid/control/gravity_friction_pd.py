"""PD control with gravity and friction compensation: document 2's nonlinear controller."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import tanh

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.rig import Target

from .estimate_checks import model_to_compensate
from .friction import SMOOTH, FrictionCompensation, with_friction
from .law import RATE, State, gains
from .model import ControlModel, ModelSource
from .pd import PD


@dataclass(frozen=True, eq=False)
class GravityFrictionPD:
    """τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) + G(θ) + F_r(θ, θ̇) (doc. 2, eq. (25))."""

    # Springs and offsets depend on the angle as gravity does, and are compensated with it.

    feedback: PD  # PD feedback
    model: ControlModel  # model of gravity and friction
    friction: FrictionCompensation | None = SMOOTH  # friction compensation; None for none

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.feedback.rate

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        if state.q.ndim == 1 and self._joints:
            return self._of_one_leg(state, target)
        torque = self.feedback.torque(state, target) + self.model.statics(state.q)
        return with_friction(torque, self.friction, self.model, state, target)

    def _of_one_leg(self, state: State, target: Target) -> FloatArray:
        """Compute the same for one leg in plain floats, which is faster than arrays of two or three numbers."""
        width = 0.0 if self.friction is None else self.friction.width
        q, v, aim, speed = state.q.tolist(), state.v.tolist(), target.q.tolist(), target.v.tolist()
        sliding = speed if self.friction is not None and self.friction.velocity == "desired" else v
        torques = []
        for (kp, kd, springs, c0, d), torque, x, y, x_d, y_d, slide in zip(
            self._joints, self.model.gravity(state.q).tolist(), q, v, aim, speed, sliding, strict=True
        ):
            spring = 0.0
            for coefficient in springs:
                spring = spring * x + coefficient
            sign = tanh(slide / width) if width > 0.0 else (slide > 0.0) - (slide < 0.0)
            torques.append(kp * (x_d - x) + kd * (y_d - y) + torque + spring + c0 * sign + d * slide)
        return np.array(torques)

    @cached_property
    def _joints(self) -> list[tuple[float, float, list[float], float, float]]:
        """Kp, Kd, spring polynomial, c0 and d of each joint; empty if the model has other terms."""
        kp, kd, n = self.feedback.kp, self.feedback.kd, self.model.n
        if self.model.others or not {kp.shape, kd.shape} <= {(), (n,)}:
            return []
        scale = 0.0 if self.friction is None else self.friction.scale
        springs = [np.trim_zeros(row, "f").tolist() for row in self.model.spring.T]
        rows = (np.broadcast_to(row, n).tolist() for row in (kp, kd))
        friction = ((scale * row).tolist() for row in (self.model.coulomb, self.model.viscous))
        return list(zip(*rows, springs, *friction, strict=True))


def gravity_friction_pd(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = SMOOTH,
    rate: float = RATE,
) -> GravityFrictionPD:
    """Make a :class:`GravityFrictionPD` controller from a model of the leg.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        friction: Friction compensation; None for gravity compensation only.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative, or the source has no control model.

    Warns:
        UserWarning: The friction coefficients are negative: compensating them destabilises the leg.

    Example:
        >>> law = gravity_friction_pd(est, kp=(22.0, 56.0), kd=(2.2, 5.6))  # doctest: +SKIP
    """
    model = model_to_compensate(source, friction)
    return GravityFrictionPD(PD(gains(kp, "kp"), gains(kd, "kd"), rate), model, friction)
