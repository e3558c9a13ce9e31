"""PD control with gravity and friction compensation: document 2's nonlinear controller."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import copysign, tanh
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.identification import Estimate
from exoid.leg import Leg
from exoid.rig import Plant, Target

from .friction import SMOOTH, FrictionCompensation
from .law import RATE, State, gains, refuse_rate
from .model import ControlModel
from .pd import PD
from .suspicion import warn_of_active_friction


class _Joint(NamedTuple):
    """A joint of the law in plain floats: gains, spring polynomial, and the friction that is compensated."""

    kp: float
    kd: float
    spring: list[float]
    c0: float
    d: float


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
        if self._joints is not None and state.q.ndim == 1:
            return self._torque_of_one(state, target, self._joints)
        torque = self.feedback.torque(state, target) + self.model.statics(state.q)
        return torque if self.friction is None else torque + self.friction.torque(self.model, state, target)

    def _torque_of_one(self, state: State, target: Target, joints: list[_Joint]) -> FloatArray:
        """The same in plain floats: arrays of three numbers cost more than their arithmetic does."""
        q, v, qd, vd = state.q.tolist(), state.v.tolist(), target.q.tolist(), target.v.tolist()
        friction = self.friction or SMOOTH  # where there is none its coefficients are zero
        rubbing = vd if friction.velocity == "desired" else v
        sign, scale = (_sgn, 1.0) if friction.width == 0.0 else (tanh, 1.0 / friction.width)
        gravity = self.model.gravity_of_one(state.q).tolist()
        torque = []
        for (kp, kd, spring, c0, d), x, w, xd, wd, u, g in zip(joints, q, v, qd, vd, rubbing, gravity, strict=True):
            statics = g + _horner(spring, x) if spring else g
            torque.append(kp * (xd - x) + kd * (wd - w) + statics + c0 * sign(scale * u) + d * u)
        return np.array(torque)

    @cached_property
    def _joints(self) -> list[_Joint] | None:
        """Each joint in plain floats; None where gains are those of several legs, or terms need arrays."""
        kp, kd, model = self.feedback.kp, self.feedback.kd, self.model
        if max(kp.ndim, kd.ndim) > 1 or model.others:
            return None
        share = 0.0 if self.friction is None else self.friction.scale
        springs = [np.trim_zeros(polynomial, "f").tolist() for polynomial in model.spring.T]
        every = (np.broadcast_to(x, model.n).tolist() for x in (kp, kd, share * model.coulomb, share * model.viscous))
        stiffness, damping, coulomb, viscous = every
        return [_Joint(*each) for each in zip(stiffness, damping, springs, coulomb, viscous, strict=True)]


def _sgn(x: float) -> float:
    return copysign(1.0, x) if x else 0.0


def _horner(coefficients: list[float], x: float) -> float:
    value = 0.0
    for coefficient in coefficients:
        value = value * x + coefficient
    return value


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
