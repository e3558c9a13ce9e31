"""Assistance as needed: help outside a tunnel about the target, which grows with the error and fades with success."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import REFERENCE, Dialect, LawInC
from exoid.codegen.law_in_c import per_joint
from exoid.codegen.templates import step_of
from exoid.errors import BadArgumentError
from exoid.rig import Target

from .c_description import describe
from .friction import PASSIVE, PassiveFriction, wearer_friction
from .law import RATE, State, freeze_gains, gains, refuse_rate, spread
from .model import ControlModel, ModelSource

TUNNEL = float(np.deg2rad(4.0))
"""Default half width of the tunnel [rad]."""


class Learnt(NamedTuple):
    """Memory: assistance that was learnt."""

    torque: FloatArray  # torque [N·m], (n,) or (n, B)


@dataclass(frozen=True, eq=False)
class AssistAsNeeded:
    """τ = Ĝ + ŝ + τ_f + K ε + w D ė + u, a :class:`exoid.control.StatefulLaw` (tunnel: Banala et al. 2009)."""

    # With e = θ_d − θ, ε is the part of e beyond the tunnel ±b and w = |ε| / (|ε| + b). Within the tunnel the
    # leg is transparent. The learnt assistance u obeys u̇ = g ε − u / T_f (forgetting: Wolbrecht et al. 2008):
    # it grows while the wearer needs help, and fades when they do not.

    stiffness: FloatArray  # stiffness K beyond the tunnel [N·m/rad], a number or (n,)
    damping: FloatArray  # damping D beyond the tunnel [N·m·s/rad], likewise
    model: ControlModel  # model of the leg
    tunnel: FloatArray  # half width b of the tunnel [rad], likewise
    learning: FloatArray  # gain g [N·m/(rad·s)], likewise; 0 for assistance without memory
    forgetting: float = 3.0  # time T_f in which learnt assistance fades to 37 % [s]
    friction: PassiveFriction | None = PASSIVE  # friction compensation, which never drives; None for none
    rate: float = RATE  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check the numbers."""
        refuse_rate(self.rate)
        freeze_gains(self, "stiffness", "damping", "tunnel", "learning")
        if not ((self.tunnel > 0.0).all() and 0.0 < self.forgetting < np.inf):
            raise BadArgumentError(
                f"a tunnel of {self.tunnel!r} rad, forgotten in {self.forgetting:g} s", remedy="give positive numbers"
            )

    def begin(self, state: State) -> Learnt:
        """Compute the memory before the first sample."""
        return Learnt(np.zeros_like(state.q))

    def step(self, memory: Learnt, state: State, target: Target) -> tuple[FloatArray, Learnt]:
        """Compute the torque; see the class."""
        q, v = state.q, state.v
        error, tunnel = target.q - q, spread(self.tunnel, q)
        beyond = error - np.clip(error, -tunnel, tunnel)
        weight = np.abs(beyond) / (np.abs(beyond) + tunnel)
        help_ = spread(self.stiffness, q) * beyond + weight * spread(self.damping, q) * (target.v - v)
        torque = self.model.statics(q) + wearer_friction(self.friction, self.model, q, v) + help_ + memory.torque
        kept = float(np.exp(-1.0 / (self.rate * self.forgetting)))
        gained = self.forgetting * (1.0 - kept) * spread(self.learning, q) * beyond
        return torque, Learnt(kept * memory.torque + gained)

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C."""
        stiffness, damping, tunnel, learning = (
            per_joint(getattr(self, name), name, self.model.n)
            for name in ("stiffness", "damping", "tunnel", "learning")
        )
        kept = float(np.exp(-1.0 / (self.rate * self.forgetting)))
        return describe(
            self.model,
            self.friction,
            self.rate,
            dialect,
            equation="tau = G(q) + springs(q){friction} + K e' + w D (v_d - v) + learnt, "
            "e' the error beyond the tunnel",
            step=step_of("assist_as_needed"),
            calls=("gravity", "springs"),
            inputs=REFERENCE,
            tables={
                "kp": (stiffness, "K beyond the tunnel [N m/rad]"),
                "kd": (damping, "D beyond the tunnel [N m s/rad]"),
                "tunnel": (tunnel, "half width of the tunnel [rad]"),
                "gained": (self.forgetting * (1.0 - kept) * learning, "learnt in one step [N m/rad]"),
                "kept": (kept, "share of the learnt torque that one step keeps"),
            },
            memory={"learnt": "learnt assistance [N m]"},
        )


def assist_as_needed(
    source: ModelSource,
    stiffness: ArrayLike,
    damping: ArrayLike,
    *,
    tunnel: ArrayLike = TUNNEL,
    learning: ArrayLike = 0.0,
    forgetting: float = 3.0,
    friction: PassiveFriction | None = PASSIVE,
    rate: float = RATE,
) -> AssistAsNeeded:
    """Make an :class:`AssistAsNeeded` controller.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        stiffness: Stiffness beyond the tunnel [N·m/rad], a number or one for each joint.
        damping: Damping beyond the tunnel [N·m·s/rad].
        tunnel: Half width of the tunnel about the target [rad].
        learning: Gain of the learnt assistance [N·m/(rad·s)]; 0 for none.
        forgetting: Time in which learnt assistance fades to 37 % [s].
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A number does not fit, or the source has no control model.

    Example:
        >>> law = assist_as_needed(est, stiffness=80.0, damping=4.0, learning=40.0)  # doctest: +SKIP
    """
    tracking = gains(stiffness, "stiffness"), gains(damping, "damping")
    tunnelled = gains(tunnel, "tunnel"), gains(learning, "learning")
    return AssistAsNeeded(*tracking, ControlModel.of(source), *tunnelled, forgetting, friction, rate)
