"""Dry friction beyond that of Coulomb: it depends on speed, load or temperature."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .motion import JointMotion
from .term import NonlinearParameter, number
from .terms import DryFriction


@dataclass(frozen=True, kw_only=True)
class Stribeck(DryFriction):
    """Stribeck friction, τ = cs exp(−(v / velocity)²) z, in addition to :class:`Coulomb`.

    Dry friction falls from c0 + cs at breakaway to c0 at high speed. With cs < 0 it grows with speed to a limit.

    Attributes:
        velocity: Stribeck velocity vs [rad/s], or :class:`NonlinearParameter` for the fit to find it.
    """

    velocity: float | NonlinearParameter = 0.1

    def __post_init__(self) -> None:
        """Check that all settings make sense."""
        super().__post_init__()
        if not isinstance(self.velocity, NonlinearParameter) and not 0.0 < self.velocity < np.inf:
            raise BadArgumentError(
                f"Stribeck(velocity={self.velocity})", remedy="a velocity in rad/s, positive, or NonlinearParameter"
            )

    symbols = ("cs",)
    units = ("N·m",)

    @property
    def nonlinear_symbols(self) -> Mapping[str, tuple[str, str]]:
        """Symbols of dry friction, and vs of the velocity."""
        return {**super().nonlinear_symbols, "velocity": ("vs", "rad/s")}

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column exp(−(v / velocity)²) z."""
        self.direction(motion, out[0])
        out[0] *= np.exp(-((motion.v / number(self.velocity)) ** 2))


@dataclass(frozen=True, kw_only=True)
class LoadFriction(DryFriction):
    """Load-dependent friction, τ = mu |τ_rb| z, proportional to the torque that a gear carries.

    τ_rb is the rigid-body torque of the *model*, with payloads and measured wrenches, so the fit alternates between it
    and mu. The measured torque cannot take its place: it contains the friction and would predict itself.

    The friction of a gear differs between driving and back-driving. With ``split``, mu_drive applies while power
    τ_rb v > 0 goes to the leg, and mu_back while it comes back. The torque is a continuous function of z:

        τ = |τ_rb| z (mu_drive (1 + z sgn τ_rb) + mu_back (1 − z sgn τ_rb)) / 2.

    While the joint slides, |τ_rb| z² sgn τ_rb = τ_rb: half of mu_drive − mu_back only scales the rigid-body torque. The
    inertias of a single joint, or of all joints together, absorb this scale. Only reversals then separate the two
    coefficients: predictions improve, single parameters become uncertain, and the estimate warns.

    Attributes:
        split: Whether driving and back-driving have separate coefficients.
    """

    split: bool = False

    loaded = True

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbol mu, or mu_drive and mu_back."""
        return ("mu_drive", "mu_back") if self.split else ("mu",)

    @property
    def units(self) -> tuple[str, ...]:
        """Dimensionless."""
        return ("1",) * len(self.symbols)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """All symbols."""
        return self.symbols

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column |τ_rb| z, or its driving and its back-driving part."""
        self.direction(motion, out[0])
        if self.split:
            outwards = out[0] * np.sign(motion.load)
            np.multiply(out[0], 0.5 * (1.0 - outwards), out=out[1])
            out[0] *= 0.5 * (1.0 + outwards)
        out *= np.abs(motion.load)


@dataclass(frozen=True, kw_only=True)
class TemperatureFriction(DryFriction):
    """Change of Coulomb and viscous friction with temperature, τ = (c0T z + dT q̇) (T − T0).

    It stands beside :class:`Coulomb` and :class:`Viscous`, whose c0 and d are those at T0 then:
    τ = [c0 + c0T (T − T0)] z + [d + dT (T − T0)] q̇. Grease gets thinner as it warms up: c0T and dT are negative in most
    gears. Give it the smoothing of :class:`Coulomb`. T is the column ``temp_<joint>`` of every recording, and has to
    change while the joint moves: by 10 K or more, or between recordings.

    Attributes:
        reference: Temperature T0 [°C]. Another one changes c0 and d, and not the torque.

    Raises:
        ExoidError: The reference is no temperature in °C, or a setting of dry friction is wrong.

    Example:
        >>> term = TemperatureFriction(smoothing=0.0)
        >>> out = np.zeros((2, 1))
        >>> motion = np.array([0.0]), np.array([2.0]), np.array([0.0]), np.array([0.0])
        >>> term.fill(JointMotion(*motion, temperature=np.array([35.0])), out)
        >>> out.ravel()
        array([10., 20.])
    """

    reference: float = 25.0

    symbols = ("c0T", "dT")
    units = ("N·m/K", "N·m·s/(rad·K)")
    needs_temperature = True

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        # [°C]
        if isinstance(self.reference, bool) or not -273.15 < self.reference < math.inf:
            raise BadArgumentError(
                f"TemperatureFriction(reference={self.reference})", remedy="a temperature in °C, such as 25"
            )

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns z (T − T0) and q̇ (T − T0)."""
        if motion.temperature is None:
            raise BadArgumentError(
                "TemperatureFriction needs the temperature of its joint",
                remedy="give the temperature, or identify without this term at the temperature of use",
            )
        warmer = motion.temperature - self.reference
        self.direction(motion, out[0])
        np.multiply(out[0], warmer, out=out[0])
        np.multiply(motion.v, warmer, out=out[1])
