"""Viscous friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

from .motion import JointMotion
from .term import Term


@dataclass(frozen=True, kw_only=True)
class Viscous(Term):
    """Viscous friction τ = d v; d > 0 dissipates.

    Attributes:
        asymmetric: Whether each direction has a coefficient, τ = dp max(v, 0) + dn min(v, 0).
    """

    asymmetric: bool = False

    @property
    def friction(self) -> bool:
        """True."""
        return True

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbol d, or dp forwards and dn backwards."""
        return ("dp", "dn") if self.asymmetric else ("d",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metre seconds over radians."""
        return ("N·m·s/rad",) * len(self.symbols)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """All symbols."""
        return self.symbols

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column v, or its positive and its negative part.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives the columns, (1 or 2, N).
        """
        if self.asymmetric:
            np.maximum(motion.v, 0.0, out=out[0])
            np.minimum(motion.v, 0.0, out=out[1])
        else:
            out[0] = motion.v
