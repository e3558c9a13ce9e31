"""How a law compensates friction: on which velocity, how sharply, and how much of it."""

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
"""Over which a smooth sign changes [rad/s]: several times the noise of a tachometer, a tenth of a slow gait's speed."""


@dataclass(frozen=True)
class FrictionCompensation:
    """F_r of doc. 2, eq. (25): c0 sgn(θ̇) + d θ̇, with a sign that may be smooth.

    On the measured velocity it acts against the friction there is, but comes late, chatters with noise where it is
    sharp, and feeds a limit cycle where it is too large. On the desired velocity it is known in advance.

    Attributes:
        velocity: "measured" or "desired".
        width: tanh(v / width) instead of sgn(v) [rad/s]; 0 for the sharp sign.
        scale: How much of the model's friction is compensated, 1 for all.

    Raises:
        ExoidError: A setting makes no sense.
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
        """Torque against friction [N·m], of the shape of ``state.q``."""
        velocity = target.v if self.velocity == "desired" else state.v
        torque = model.friction(state.q, velocity, self.width)
        return torque if self.scale == 1.0 else self.scale * torque


SMOOTH = FrictionCompensation()
"""On the measured velocity, smooth: doc. 2, eq. (25), without the chatter of its sign function."""

SHARP = FrictionCompensation(width=0.0)
"""On the measured velocity with the sign function, as doc. 2 prints it."""

AHEAD = FrictionCompensation(velocity="desired")
"""On the desired velocity, smooth."""
