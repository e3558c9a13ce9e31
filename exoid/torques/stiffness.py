"""Stiffness of springs, hoses and straps: a torque that depends on the angle."""

from __future__ import annotations

from dataclasses import dataclass

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .motion import JointMotion
from .term import Term


@dataclass(frozen=True, kw_only=True)
class Stiffness(Term):
    """Polynomial stiffness τ = b2 q² + b1 q + b0 (doc. 1, eqs. (21), (26), with the opposite sign).

    b1 > 0 pulls the joint back to zero. b0 is equivalent to an offset of the torque sensor: use only one of them.

    Attributes:
        degree: Degree of the polynomial, 0 to 8.
    """

    degree: int = 2

    def __post_init__(self) -> None:
        """Check the degree."""
        if not isinstance(self.degree, int) or not 0 <= self.degree <= 8:
            raise ExoidError(f"stiffness of degree {self.degree}", remedy="use a whole number between 0 and 8")

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbols b2, b1, b0 for degree 2."""
        return tuple(f"b{power}" for power in range(self.degree, -1, -1))

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres over powers of radians."""
        units = {0: "N·m", 1: "N·m/rad"}
        return tuple(units.get(power, f"N·m/rad^{power}") for power in range(self.degree, -1, -1))

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns q^degree, …, q, 1.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives the columns, (degree + 1, N).
        """
        out[-1] = 1.0
        for k in range(self.degree - 1, -1, -1):
            out[k] = out[k + 1] * motion.q
