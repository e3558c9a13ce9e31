"""Friction compensation: with measured or desired velocity, sharp or smooth, and which share of the friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import State
from .model import ControlModel

WIDTH = 0.05
"""Width of a smooth sign [rad/s]: several times the noise of a tachometer, a tenth of the speed of a slow gait."""


@dataclass(frozen=True)
class FrictionCompensation:
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
        known = self.velocity in ("measured", "desired")
        if not (known and 0.0 <= self.width < np.inf and np.isfinite(self.scale)):
            raise ExoidError(f"no such friction compensation: {self}", remedy='velocity is "measured" or "desired"')

    def torque(self, model: ControlModel, state: State, target: Target) -> FloatArray:
        """Compute the torque that compensates friction.

        Args:
            model: Model with the friction coefficients.
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``.
        """
        velocity = target.v if self.velocity == "desired" else state.v
        torque = model.friction(state.q, velocity, self.width)
        return torque if self.scale == 1.0 else self.scale * torque


def with_friction(
    torque: FloatArray, friction: FrictionCompensation | None, model: ControlModel, state: State, target: Target
) -> FloatArray:
    """Add friction compensation to the torque of a controller."""
    return torque if friction is None else torque + friction.torque(model, state, target)


SMOOTH = FrictionCompensation()
"""Measured velocity, smooth: doc. 2, eq. (25), without the chatter of the sign function."""

SHARP = FrictionCompensation(width=0.0)
"""Measured velocity with the sign function, as doc. 2 prints it."""

AHEAD = FrictionCompensation(velocity="desired")
"""Desired velocity, smooth."""
