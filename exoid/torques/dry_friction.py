"""Dry friction, which changes sign with the direction of motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .internal_state import InternalState
from .motion import JointMotion
from .nonlinear import NonlinearParameter, number
from .presliding import Presliding
from .term import Term


@dataclass(frozen=True, kw_only=True)
class DryFriction(Term):
    """Friction proportional to the direction z of motion: sgn(v), tanh(v / smoothing), or a presliding state.

    Attributes:
        smoothing: Velocity over which the sign changes [rad/s]; 0 for a sharp sign.
        presliding: Presliding length δ of :class:`exoid.torques.Presliding` [rad], about 1 mrad in gears; it replaces
            the smoothing. 0 for none.
        dead_band: Speed up to which samples are left out of the fit [rad/s], as in doc. 1, sec. III-G; the columns are
            zero there.

    Raises:
        ExoidError: A setting is negative or not finite, or smoothing is nonlinear beside presliding.
    """

    smoothing: float | NonlinearParameter = 0.02
    presliding: float | NonlinearParameter = 0.0
    dead_band: float = 0.0

    def __post_init__(self) -> None:
        """Check the settings."""
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
                f"{type(self).__name__} has a nonlinear smoothing, which presliding replaces",
                remedy="leave out one of the two",
            )

    @property
    def friction(self) -> bool:
        """True."""
        return True

    @property
    def nonlinear_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Symbols ws of the smoothing and delta of presliding."""
        return {"smoothing": ("ws", "rad/s"), "presliding": ("delta", "rad")}

    @property
    def internal_state(self) -> InternalState | None:
        """Presliding state; None without presliding."""
        length = number(self.presliding)
        return Presliding(length) if length > 0.0 else None

    def direction(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the direction z, between −1 and 1, zero in the dead band.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives z, (N,).

        Raises:
            ExoidError: A setting is a :class:`NonlinearParameter`.
        """
        if motion.state is not None:
            out[:] = motion.state
        elif (smoothing := number(self.smoothing)) > 0.0:
            with np.errstate(over="ignore"):  # a tiny smoothing: tanh of infinity is 1
                np.tanh(np.divide(motion.v, smoothing, out=out), out=out)
        else:
            np.sign(motion.v, out=out)
        if self.dead_band > 0.0:
            out[~self.usable(motion.v)] = 0.0

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Select the samples outside the dead band.

        Args:
            v: Velocity of the joint [rad/s], (N,).

        Returns:
            Whether each sample is outside, (N,).
        """
        return np.asarray(np.abs(v) > self.dead_band) if self.dead_band > 0.0 else super().usable(v)
