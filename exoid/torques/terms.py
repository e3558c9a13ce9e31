"""Built-in terms: Coulomb and viscous friction, rotor inertia, sensor offset and stiffness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked

from .motion import JointMotion
from .presliding import Presliding
from .term import Term

SMOOTHING, REVERSAL = 0.015, 0.03
"""Usual velocity over which dry friction changes its sign, and speed at which a joint may stick [rad/s]."""

SIGN_WIDTH = 0.02
"""Velocity over which the efficiency of a drive, and friction that no term describes, change their sign [rad/s]."""

SLOW = 0.05
"""Largest reversal speed over the RMS velocity: slow motion is no reversal."""


def reversals(v: FloatArray, speed: float) -> NDArray[np.bool_] | None:
    """Select samples slower than a speed, or at a change of sign."""
    if speed == 0.0 or not v.any():
        return None
    slow = np.abs(v) <= min(speed, SLOW * float(np.sqrt(np.mean(v**2))))
    turns = v[1:] * v[:-1] < 0.0
    slow[1:] |= turns
    slow[:-1] |= turns
    return np.asarray(slow)


@dataclass(frozen=True, kw_only=True)
class DryFriction(Term):
    """Friction proportional to the direction z of motion: sgn(v), tanh(v / smoothing), or a presliding state.

    At a prismatic joint settings are in m and m/s. Those that are left as usual are 0.1 m or m/s for each rad or rad/s.

    Attributes:
        smoothing: Velocity over which the sign changes [rad/s]; 0 for a sharp sign.
        presliding: Presliding length δ of :class:`exoid.torques.Presliding` [rad], about 1 mrad in gears; it replaces
            the smoothing. 0 for none.
        dead_band: Speed up to which samples are left out of the fit [rad/s], as in doc. 1, sec. III-G; the columns are
            zero there.
        reversal_speed: Speed below which a joint that turns round may stick [rad/s], at most :data:`SLOW` of the RMS
            velocity. A fit behind the parallel filter takes friction there for unknown; a prediction smooths it. 0 for
            friction that is a function of velocity throughout. With presliding it has no effect.

    Raises:
        ExoidError: A setting is negative or not finite.
    """

    smoothing: float = SMOOTHING
    presliding: float = 0.0
    dead_band: float = 0.0
    reversal_speed: float = REVERSAL

    def __post_init__(self) -> None:
        """Check the settings."""
        for name in ("smoothing", "presliding", "dead_band", "reversal_speed"):
            checked(getattr(self, name), f"{name} of {type(self).__name__}", least=0.0, ndim=0)

    friction = True

    @property
    def internal_state(self) -> Presliding | None:
        """Presliding state; None without presliding."""
        return Presliding(self.presliding) if self.presliding > 0.0 else None

    def direction(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the direction z, between −1 and 1, zero in the dead band.

        Args:
            motion: Motion of the joint, N samples.
            out: Receives z, (N,).
        """
        if motion.state is not None:
            out[:] = motion.state
        elif self.smoothing > 0.0:
            with np.errstate(over="ignore"):  # a tiny smoothing: tanh of infinity is 1
                np.tanh(np.divide(motion.v, self.smoothing, out=out), out=out)
        else:
            np.sign(motion.v, out=out)
        if self.dead_band > 0.0:
            out[~self.usable(motion.v)] = 0.0

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Select the samples outside the dead band."""
        return np.asarray(np.abs(v) > self.dead_band) if self.dead_band > 0.0 else super().usable(v)

    def reversing(self, v: FloatArray) -> NDArray[np.bool_] | None:
        """Select the samples around reversals: slower than the reversal speed, or at a change of sign."""
        return None if self.presliding > 0.0 else reversals(v, self.reversal_speed)


@dataclass(frozen=True, kw_only=True)
class Coulomb(DryFriction):
    """Coulomb friction τ = c0 z, z = tanh(v / smoothing) (doc. 1, eqs. (34)-(35), with the opposite sign).

    Friction that differs between the directions is Coulomb friction with an :class:`Offset`.
    """

    symbols = ("c0",)
    units = ("N·m",)
    nonnegative = ("c0",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column z."""
        self.direction(motion, out[0])


@dataclass(frozen=True, kw_only=True)
class Viscous(Term):
    """Viscous friction τ = d v; d > 0 dissipates."""

    symbols = ("d",)
    units = ("N·m·s/rad",)
    nonnegative = ("d",)
    friction = True

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column v."""
        out[0] = motion.v


@dataclass(frozen=True, kw_only=True)
class Armature(Term):
    """Rotor inertia reflected to the joint (armature), τ = Ia a, for torque computed on the motor's side of the gear.

    At the first joint of a planar leg it is regrouped into J1. At the other joints it is a separate parameter. It is
    zero where torque is measured behind the gear.
    """

    symbols = ("Ia",)
    units = ("kg·m²",)
    nonnegative = ("Ia",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column a."""
        out[0] = motion.a


@dataclass(frozen=True, kw_only=True)
class Offset(Term):
    """Constant torque τ = offset: the zero of a torque sensor, or friction that differs between the directions."""

    symbols = ("offset",)
    units = ("N·m",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write a column of ones."""
        out[0] = 1.0


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
            raise BadArgumentError(f"stiffness of degree {self.degree}", remedy="use a whole number between 0 and 8")

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbols b2, b1, b0 for degree 2."""
        return tuple(f"b{power}" for power in range(self.degree, -1, -1))

    @property
    def units(self) -> tuple[str, ...]:
        """Newton metres over powers of radians."""
        units = {0: "N·m", 1: "N·m/rad", 2: "N·m/rad²", 3: "N·m/rad³"}
        return tuple(units.get(power, f"N·m/rad^{power}") for power in range(self.degree, -1, -1))

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns q^degree, …, q, 1."""
        out[-1] = 1.0
        for k in range(self.degree - 1, -1, -1):
            out[k] = out[k + 1] * motion.q
