"""Rotors behind their gears."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray

from .motion import JointMotion
from .term import Term


@dataclass(frozen=True, kw_only=True)
class Armature(Term):
    """Rotor inertia reflected to the joint, τ = Ia a, where torque is computed on the motor's side of the gear.

    At the first joint of a planar leg it cannot be told from J1 and becomes part of it; at the others it is a parameter
    of its own. Where torque is measured behind the gear it is zero.
    """

    @property
    def symbols(self) -> tuple[str, ...]:
        """Return Ia."""
        return ("Ia",)

    @property
    def units(self) -> tuple[str, ...]:
        """Kilogram metres squared."""
        return ("kg·m²",)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """Return Ia."""
        return ("Ia",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Column a."""
        out[0] = motion.a
