"""Rotor inertia reflected through the gear."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray

from .motion import JointMotion
from .term import Term


@dataclass(frozen=True, kw_only=True)
class Armature(Term):
    """Rotor inertia reflected to the joint (armature), τ = Ia a, for torque computed on the motor's side of the gear.

    At the first joint of a planar leg it is regrouped into J1. At the other joints it is a separate parameter. It is
    zero where torque is measured behind the gear.
    """

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbol Ia."""
        return ("Ia",)

    @property
    def units(self) -> tuple[str, ...]:
        """Kilogram metres squared."""
        return ("kg·m²",)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """Symbol Ia."""
        return ("Ia",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column a.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives the columns, (1, N).
        """
        out[0] = motion.a
