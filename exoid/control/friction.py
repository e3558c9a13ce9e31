"""Friction compensation: with measured or desired velocity, sharp or smooth; or for a wearer, where it never drives."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Literal

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Target
from exoid.tools.numbers import checked
from exoid.torques.position_units import position_units

from .law import State
from .model import ControlModel, ModelSource

WIDTH = 0.05
"""Width of a smooth sign [rad/s]: several times the noise of a tachometer, a tenth of the speed of a slow gait."""


@dataclass(frozen=True)
class FrictionCompensation:
    """F_r of doc. 2, eq. (25), whose torque is added to that of a law: c0 sgn(θ̇) + d θ̇, with a sign that may be smooth.

    With the measured velocity the compensation follows the true motion, but it is late. A sharp sign chatters with
    noise, and too much compensation causes a limit cycle. With the desired velocity it is known in advance.

    For a wearer it must not drive the joint: it is zero where it has not the sign of the velocity. So it never gives
    more power than true friction takes, as long as the model's friction is at most 1/scale of the true one.

    Attributes:
        velocity: "measured" or "desired".
        width: tanh(v / width) instead of sgn(v) [rad/s], a tenth of it in m/s where a joint slides; 0 for sgn(v).
        scale: Share of the model's friction that is compensated, 1 for all.
        drives: Whether it may drive a joint, as friction of the wrong sign, too much of it, or a sharp sign do.

    Raises:
        ExoidError: The velocity is neither, the width is negative, or a number is not finite. Without ``drives``: the
            velocity is the desired one, the sign is sharp, or the scale is not from 0 to 1.
    """

    velocity: Literal["measured", "desired"] = "measured"
    width: float = WIDTH
    scale: float = 1.0
    drives: bool = True

    def __post_init__(self) -> None:
        """Check the settings."""
        if self.velocity not in (("measured", "desired") if self.drives else ("measured",)):
            remedy = f"use measured{' or desired' if self.drives else ', as it must not drive'}"
            raise BadArgumentError(f"friction of the velocity {self.velocity!r}", remedy=remedy)
        checked(self.width, "width", least=0.0)
        checked(self.scale, "scale")
        if not self.drives:
            checked(self.width, "width", above=0.0)  # with a sharp sign noise alone would drive a joint at rest
            checked(self.scale, "scale", least=0.0, most=1.0)  # more than all friction drives the joint

    def torque(self, model: ControlModel, state: State, target: Target) -> FloatArray:
        """Compute the torque that compensates friction.

        Args:
            model: Model whose friction it is.
            state: Measured state.
            target: Reference at this moment.

        Returns:
            Torque [N·m], of the shape of ``state.q``.
        """
        velocity = target.v if self.velocity == "desired" else state.v
        friction = model.friction(state.q, velocity, self.width)
        if not self.drives:
            friction = np.where(friction * state.v > 0.0, friction, 0.0)
        return friction if self.scale == 1.0 else self.scale * friction

    def in_c(self, measured: str) -> tuple[str, str]:
        """Write the compensation in C.

        Args:
            measured: Measured velocities, such as ``in->v``.

        Returns:
            Statements that fill ``friction``, and the words of the equation.
        """
        velocity = "in->v_d" if self.velocity == "desired" else measured
        share = "" if self.scale == 1.0 else f"{self.scale:g} "
        statements = f"    {{{{p}}}}_friction({velocity}, friction);"
        if not self.drives:
            statements += (
                "\n    for (j = 0; j < {{N}}; ++j) { /* never drives */\n"
                f"        friction[j] = friction[j] * {measured}[j] > "
                "{{number(0)}} ? friction[j] : {{number(0)}};\n"
                "    }"
            )
            return statements, f" + {share}F(v), never driving"
        return statements, f" + {share}F({velocity.split('->')[1]})"


SMOOTH = FrictionCompensation()
"""Measured velocity, smooth: doc. 2, eq. (25), without the chatter of the sign function."""

SHARP = FrictionCompensation(width=0.0)
"""Measured velocity with the sign function, as doc. 2 prints it."""

AHEAD = FrictionCompensation(velocity="desired")
"""Desired velocity, smooth."""

PASSIVE = FrictionCompensation(scale=0.9, drives=False)
"""Nine tenths of the model's friction, which never drives: for a wearer."""


def model_to_compensate(
    source: ModelSource, friction: FrictionCompensation | None, *, follows: bool = True
) -> ControlModel:
    """Make the model of a law, which may follow a motion, and warn if it compensates friction that is negative."""
    # Under eq. (6) of doc. 2, its Table III as printed would inject energy: compensating it opposes the motion.
    # Friction must resist up to 1 rad/s; slightly negative viscous friction beside Coulomb's is noise.
    wanted = "none" if friction is None else getattr(friction, "velocity", "")
    if not wanted or (wanted == "desired" and not follows):
        what = "friction of the desired velocity, where no motion is desired" if wanted else f"friction is {friction!r}"
        raise BadArgumentError(what, remedy="use SMOOTH, SHARP or PASSIVE")
    model = ControlModel.of(source)
    units = position_units(model.leg)
    wrong = [
        f"{label}: {c0:.4g} sgn(v) {d:+.4g} v {unit.torque}"
        for label, c0, d, unit in zip(model.leg.joint_labels, model.coulomb, model.viscous, units, strict=True)
        if min(c0, c0 + 1.0 * d) < 0.0
    ]
    if wrong and friction is not None and friction.drives:
        warnings.warn(
            f"friction that drives the joint ({'; '.join(wrong)}): compensating it brakes the motion that it should "
            "support. Check the sign convention; doc. 2 prints its Table III with this sign",
            UserWarning,
            stacklevel=3,
        )
    return model
