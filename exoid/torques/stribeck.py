"""What dry friction has in addition while it is slow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .dry_friction import DryFriction
from .motion import JointMotion
from .nonlinear import NonlinearParameter, number


@dataclass(frozen=True, kw_only=True)
class Stribeck(DryFriction):
    """Stribeck's drop of friction with speed, τ = cs exp(−(v / velocity)²) z, beside :class:`Coulomb`.

    At breakaway dry friction is c0 + cs, at speed c0. cs below zero is friction that grows with speed and levels off.

    Attributes:
        velocity: Speed over which it drops [rad/s], or :class:`NonlinearParameter` for the fit to find it.
    """

    velocity: float | NonlinearParameter = 0.1

    def __post_init__(self) -> None:
        """Check that all settings make sense."""
        super().__post_init__()
        if not isinstance(self.velocity, NonlinearParameter) and not 0.0 < self.velocity < np.inf:
            raise ExoidError(f"Stribeck(velocity={self.velocity})", remedy="a velocity in rad/s, positive, or Free")

    @property
    def symbols(self) -> tuple[str, ...]:
        """Return cs."""
        return ("cs",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres."""
        return ("N·m",)

    @property
    def shape_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Those of dry friction, and the velocity."""
        return {**super().shape_symbols, "velocity": ("vs", "rad/s")}

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Column exp(−(v / velocity)²) z."""
        self.direction(motion, out[0])
        out[0] *= np.exp(-((motion.v / number(self.velocity)) ** 2))
