"""Stribeck friction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .term import JointMotion, NonlinearParameter, number
from .terms import DryFriction


@dataclass(frozen=True, kw_only=True)
class Stribeck(DryFriction):
    """Stribeck friction, τ = cs exp(−(v / velocity)²) z, in addition to :class:`Coulomb`.

    Dry friction falls from c0 + cs at breakaway to c0 at high speed. With cs < 0 it grows with speed to a limit.

    Attributes:
        velocity: Stribeck velocity vs [rad/s], or :class:`NonlinearParameter` for the fit to find it.
    """

    velocity: float | NonlinearParameter = 0.1

    def __post_init__(self) -> None:
        """Check that all settings make sense."""
        super().__post_init__()
        if not isinstance(self.velocity, NonlinearParameter) and not 0.0 < self.velocity < np.inf:
            raise ExoidError(
                f"Stribeck(velocity={self.velocity})", remedy="a velocity in rad/s, positive, or NonlinearParameter"
            )

    symbols = ("cs",)
    units = ("N·m",)

    @property
    def nonlinear_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Symbols of dry friction, and vs of the velocity."""
        return {**super().nonlinear_symbols, "velocity": ("vs", "rad/s")}

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column exp(−(v / velocity)²) z."""
        self.direction(motion, out[0])
        out[0] *= np.exp(-((motion.v / number(self.velocity)) ** 2))
