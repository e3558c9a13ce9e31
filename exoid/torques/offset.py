"""Offset of a torque sensor."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray

from .motion import JointMotion
from .term import Term


@dataclass(frozen=True, kw_only=True)
class Offset(Term):
    """Constant torque τ = offset: the zero of a torque sensor, or friction that differs between the directions."""

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbol offset."""
        return ("offset",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres."""
        return ("N·m",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write a column of ones.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives the columns, (1, N).
        """
        out[0] = 1.0
