"""Coulomb friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

from .dry_friction import DryFriction
from .motion import JointMotion


@dataclass(frozen=True, kw_only=True)
class Coulomb(DryFriction):
    """Coulomb friction τ = c0 z, z = tanh(v / smoothing) (doc. 1, eqs. (34)-(35), with the opposite sign).

    Attributes:
        asymmetric: Whether each direction has a coefficient, τ = c0p max(z, 0) + c0n min(z, 0). Half the difference is
            nearly equivalent to an offset of the torque sensor: leave :class:`Offset` out then.
    """

    asymmetric: bool = False

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbol c0, or c0p forwards and c0n backwards."""
        return ("c0p", "c0n") if self.asymmetric else ("c0",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres."""
        return ("N·m",) * len(self.symbols)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """All symbols."""
        return self.symbols

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column z, or its positive and its negative part.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives the columns, (1 or 2, N).
        """
        self.direction(motion, out[0])
        if self.asymmetric:
            np.minimum(out[0], 0.0, out=out[1])
            np.maximum(out[0], 0.0, out=out[0])
