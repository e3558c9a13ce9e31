"""The zero of a torque sensor."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray

from .motion import JointMotion
from .term import Term


@dataclass(frozen=True, kw_only=True)
class Offset(Term):
    """Constant torque τ = offset: a sensor's zero, or friction that differs between the two directions."""

    @property
    def symbols(self) -> tuple[str, ...]:
        """Return offset."""
        return ("offset",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres."""
        return ("N·m",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Column of ones."""
        out[0] = 1.0
