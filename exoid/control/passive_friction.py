"""Friction compensation for a wearer, which never drives the joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .friction import WIDTH
from .law import State
from .model import ControlModel

SHARE = 0.9
"""Default share of the model's friction that is compensated."""


@dataclass(frozen=True)
class PassiveFriction:
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

    share: float = SHARE
    width: float = WIDTH

    def __post_init__(self) -> None:
        """Check the settings."""
        if not 0.0 <= self.share <= 1.0:
            raise ExoidError(
                f"compensation of {self.share:g} times the friction",
                remedy="give a share from 0 to 1: more than all friction drives the joint",
            )
        if not 0.0 < self.width < np.inf:
            raise ExoidError(f"a smooth sign of width {self.width:g} rad/s", remedy="give a positive width")

    def of(self, model: ControlModel, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque that compensates friction.

        Args:
            model: Model with the friction coefficients.
            q: Measured angles [rad], (n,) or (n, B).
            v: Measured velocities [rad/s], likewise.

        Returns:
            Torque [N·m], of the same shape.
        """
        friction = model.friction(q, v, self.width)
        return np.asarray(np.where(friction * v > 0.0, self.share * friction, 0.0))

    def torque(self, model: ControlModel, state: State, target: Target) -> FloatArray:
        """Compute the torque that compensates friction, at the measured velocity.

        Args:
            model: Model with the friction coefficients.
            state: Measured state, (n,) or (n, B).
            target: Not used.

        Returns:
            Torque [N·m], of the shape of ``state.q``.
        """
        return self.of(model, state.q, state.v)


PASSIVE = PassiveFriction()
"""Nine tenths of the model's friction."""


def wearer_friction(friction: PassiveFriction | None, model: ControlModel, q: FloatArray, v: FloatArray) -> FloatArray:
    """Compute the torque of a friction compensation that may be absent."""
    return np.zeros_like(v) if friction is None else friction.of(model, q, v)
