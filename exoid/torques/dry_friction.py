"""What all friction between solids has in common: it changes sign with the direction of motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .memory import Memory
from .motion import JointMotion
from .nonlinear import NonlinearParameter, number
from .presliding import Presliding
from .term import Term


@dataclass(frozen=True, kw_only=True)
class DryFriction(Term):
    """A size times the direction z of motion: sgn(v), tanh(v / smoothing), or a state that bends before it slides.

    Attributes:
        smoothing: Velocity over which the sign changes [rad/s]; 0 for a sharp sign.
        presliding: Angle over which the contact bends after a reversal, δ of :class:`exoid.torques.Presliding` [rad],
            about 1 mrad in gears; it then takes the place of the smoothing. 0 for none.
        dead_band: Samples at or below this speed [rad/s] say nothing on friction and are left out of the fit, as in
            doc. 1, sec. III-G; the columns are zero there.
    """

    smoothing: float | NonlinearParameter = 0.02
    presliding: float | NonlinearParameter = 0.0
    dead_band: float = 0.0

    def __post_init__(self) -> None:
        """Check that all settings make sense."""
        for name, unit in (("smoothing", "a velocity in rad/s"), ("presliding", "an angle in rad")):
            value = getattr(self, name)
            if not isinstance(value, NonlinearParameter) and not 0.0 <= value < np.inf:
                raise ExoidError(
                    f"{type(self).__name__}({name}={value})", remedy=f"{unit}, zero or positive, or NonlinearParameter"
                )
        if not 0.0 <= self.dead_band < np.inf:
            raise ExoidError(
                f"{type(self).__name__}(dead_band={self.dead_band})", remedy="a velocity in rad/s, zero or positive"
            )
        if isinstance(self.smoothing, NonlinearParameter) and self.presliding != 0.0:
            raise ExoidError(
                f"{type(self).__name__} has a free smoothing, of which presliding takes the place",
                remedy="leave out one of the two",
            )

    @property
    def friction(self) -> bool:
        """It is."""
        return True

    @property
    def shape_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Smoothing and presliding."""
        return {"smoothing": ("ws", "rad/s"), "presliding": ("delta", "rad")}

    @property
    def memory(self) -> Memory | None:
        """The bend of the contact, if it bends."""
        length = number(self.presliding)
        return Presliding(length) if length > 0.0 else None

    def direction(self, motion: JointMotion, out: FloatArray) -> None:
        """Write z, between −1 and 1, zero in the dead band, (N,)."""
        if motion.memory is not None:
            out[:] = motion.memory
        elif (smoothing := number(self.smoothing)) > 0.0:
            with np.errstate(over="ignore"):  # a tiny smoothing: tanh of infinity is 1
                np.tanh(np.divide(motion.v, smoothing, out=out), out=out)
        else:
            np.sign(motion.v, out=out)
        if self.dead_band > 0.0:
            out[~self.usable(motion.v)] = 0.0

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Outside the dead band."""
        return np.asarray(np.abs(v) > self.dead_band) if self.dead_band > 0.0 else super().usable(v)
