"""Kinetic friction of constant size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .term import Term


@dataclass(frozen=True, kw_only=True)
class Coulomb(Term):
    """Coulomb friction τ = c0 sgn(v), or τ = c0 tanh(v / smoothing) (doc. 1, eqs. (34)-(35), with the opposite sign).

    Attributes:
        smoothing: Velocity over which the sign changes [rad/s]; 0 for a sharp sign.
        dead_band: Samples at or below this speed [rad/s] say nothing on friction and are left out of the fit, as in
            doc. 1, sec. III-G; the column is zero there.
    """

    smoothing: float = 0.02
    dead_band: float = 0.0

    def __post_init__(self) -> None:
        """Check that both velocities make sense."""
        if not (0.0 <= self.smoothing < np.inf and 0.0 <= self.dead_band < np.inf):
            raise ExoidError(
                f"Coulomb(smoothing={self.smoothing}, dead_band={self.dead_band})",
                remedy="both are velocities in rad/s, zero or positive",
            )

    @property
    def symbols(self) -> tuple[str, ...]:
        """Return c0."""
        return ("c0",)

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres."""
        return ("N·m",)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """Return c0."""
        return ("c0",)

    def fill(self, q: FloatArray, v: FloatArray, a: FloatArray, out: FloatArray) -> None:
        """Column sgn(v), sharp or smooth, zero in the dead band."""
        if self.smoothing > 0.0:
            np.tanh(np.divide(v, self.smoothing, out=out[0]), out=out[0])
        else:
            np.sign(v, out=out[0])
        if self.dead_band > 0.0:
            out[0][~self.usable(v)] = 0.0

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Outside the dead band."""
        return np.asarray(np.abs(v) > self.dead_band) if self.dead_band > 0.0 else super().usable(v)
