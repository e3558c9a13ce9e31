"""Friction proportional to velocity."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray

from .term import Term


@dataclass(frozen=True, kw_only=True)
class Viscous(Term):
    """Viscous friction τ = d v; d > 0 dissipates."""

    @property
    def symbols(self) -> tuple[str, ...]:
        """Return d."""
        return ("d",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metre seconds over radians."""
        return ("N·m·s/rad",)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """Return d."""
        return ("d",)

    def fill(self, q: FloatArray, v: FloatArray, a: FloatArray, out: FloatArray) -> None:
        """Column v."""
        out[0] = v
