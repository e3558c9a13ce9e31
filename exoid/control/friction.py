"""Friction compensation: with measured or desired velocity, sharp or smooth; or for a wearer, where it never drives."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Target
from exoid.tools.numbers import checked

from .law import State
from .model import ControlModel, ModelSource

WIDTH = 0.05
"""Width of a smooth sign [rad/s]: several times the noise of a tachometer, a tenth of the speed of a slow gait."""


class Friction(ABC):
    """Friction compensation, whose torque is to be added to that of a law."""

    width: float  # width of the smooth sign [rad/s]
    scale: float  # share of the model's friction that is compensated

    @abstractmethod
    def torque(self, model: ControlModel, state: State, target: Target) -> FloatArray:
        """Compute the torque that compensates friction [N·m], of the shape of ``state.q``."""

    @abstractmethod
    def in_c(self, measured: str) -> tuple[str, str]:
        """Write statements that fill ``friction``, at velocities such as ``in->v``, and the words of the equation."""


@dataclass(frozen=True)
class FrictionCompensation(Friction):
    """F_r of doc. 2, eq. (25): c0 sgn(θ̇) + d θ̇, with a sign that may be smooth.

    With the measured velocity the compensation follows the true motion, but it is late. A sharp sign chatters with
    noise, and too much compensation causes a limit cycle. With the desired velocity it is known in advance.

    Attributes:
        velocity: "measured" or "desired".
        width: tanh(v / width) instead of sgn(v) [rad/s]; 0 for the sharp sign.
        scale: Share of the model's friction that is compensated, 1 for all.

    Raises:
        ExoidError: The velocity is neither, the width is negative, or a number is not finite.
    """

    velocity: Literal["measured", "desired"] = "measured"
    width: float = WIDTH
    scale: float = 1.0

    def __post_init__(self) -> None:
        """Check the settings."""
        if self.velocity not in ("measured", "desired"):
            raise BadArgumentError(f"friction of the velocity {self.velocity!r}", remedy="use measured or desired")
        checked(self.width, "width", least=0.0)
        checked(self.scale, "scale")

    def torque(self, model: ControlModel, state: State, target: Target) -> FloatArray:
        """Compute the torque that compensates friction."""
        velocity = target.v if self.velocity == "desired" else state.v
        friction = model.friction(state.q, velocity, self.width)
        return friction if self.scale == 1.0 else self.scale * friction

    def in_c(self, measured: str) -> tuple[str, str]:
        """Write the compensation in C."""
        velocity = "in->v_d" if self.velocity == "desired" else measured
        share = "" if self.scale == 1.0 else f"{self.scale:g} "
        return f"    {{{{p}}}}_friction({velocity}, friction);", f" + {share}F({velocity.split('->')[1]})"


@dataclass(frozen=True)
class PassiveFriction(Friction):
    """τ_f = share · r(v) where r(v) v > 0, else 0, with r(v) = c0 tanh(v / width) + d v of the model.

    It is zero at rest, has the sign of the velocity, and is at most ``share`` of the model's friction. So it never
    gives more power to the joint than true friction takes, as long as the model's friction is at most 1/share of the
    true one. Friction that a model has with the wrong sign is not compensated.

    Attributes:
        share: Share of the model's friction that is compensated, 0 to 1.
        width: Width of the smooth sign [rad/s], positive: with a sharp sign noise alone would drive a joint at rest.

    Raises:
        ExoidError: The share is not from 0 to 1, or the width is not positive.
    """

    share: float = 0.9
    width: float = WIDTH

    def __post_init__(self) -> None:
        """Check the settings."""
        checked(self.share, "share", least=0.0, most=1.0)  # more than all friction drives the joint
        checked(self.width, "width", above=0.0)

    @property
    def scale(self) -> float:  # type: ignore[override]
        """Share of the model's friction that is compensated."""
        return self.share

    def torque(self, model: ControlModel, state: State, target: Target) -> FloatArray:
        """Compute the torque that compensates friction, at the measured velocity."""
        friction = model.friction(state.q, state.v, self.width)
        return np.asarray(np.where(friction * state.v > 0.0, self.scale * friction, 0.0))

    def in_c(self, measured: str) -> tuple[str, str]:
        """Write the compensation in C."""
        statements = (
            f"    {{{{p}}}}_friction({measured}, friction);\n"
            "    for (j = 0; j < {{N}}; ++j) { /* never drives */\n"
            f"        friction[j] = friction[j] * {measured}[j] > "
            "{{number(0)}} ? friction[j] : {{number(0)}};\n"
            "    }"
        )
        return statements, f" + {self.share:g} F(v), never driving"


SMOOTH = FrictionCompensation()
"""Measured velocity, smooth: doc. 2, eq. (25), without the chatter of the sign function."""

SHARP = FrictionCompensation(width=0.0)
"""Measured velocity with the sign function, as doc. 2 prints it."""

AHEAD = FrictionCompensation(velocity="desired")
"""Desired velocity, smooth."""

PASSIVE = PassiveFriction()
"""Nine tenths of the model's friction."""


def wearer_friction(friction: PassiveFriction | None, model: ControlModel, q: FloatArray, v: FloatArray) -> FloatArray:
    """Compute the torque of a friction compensation that may be absent."""
    return np.zeros_like(v) if friction is None else friction.torque(model, State(q, v), Target(q, v))


def model_to_compensate(source: ModelSource, friction: FrictionCompensation | None) -> ControlModel:
    """Make the model of a law, and warn if it compensates friction that is negative."""
    # Under eq. (6) of doc. 2, its Table III as printed would inject energy: compensating it opposes the motion.
    # Friction must resist up to 1 rad/s; slightly negative viscous friction beside Coulomb's is noise.
    model = ControlModel.of(source)
    wrong = [
        f"{label}: {c0:.4g} sgn(v) {d:+.4g} v N·m"
        for label, c0, d in zip(model.leg.joint_labels, model.coulomb, model.viscous, strict=True)
        if min(c0, c0 + 1.0 * d) < 0.0
    ]
    if wrong and friction is not None:
        warnings.warn(
            f"friction that drives the joint ({'; '.join(wrong)}): compensating it brakes the motion that it should "
            "support. Check the sign convention; doc. 2 prints its Table III with this sign",
            UserWarning,
            stacklevel=3,
        )
    return model
