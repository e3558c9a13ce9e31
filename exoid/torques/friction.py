"""Dry friction beyond that of Coulomb: it depends on speed or load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.tools.numbers import checked

from .motion import JointMotion
from .terms import DryFriction


@dataclass(frozen=True, kw_only=True)
class Stribeck(DryFriction):
    """Stribeck friction, τ = cs exp(−(v / velocity)²) z, in addition to :class:`Coulomb`.

    Dry friction falls from c0 + cs at breakaway to c0 at high speed. With cs < 0 it grows with speed to a limit.

    Attributes:
        velocity: Stribeck velocity vs [rad/s].
    """

    velocity: float = 0.1

    def __post_init__(self) -> None:
        """Check that all settings make sense."""
        super().__post_init__()
        checked(self.velocity, "velocity of Stribeck [rad/s]", above=0.0, ndim=0)

    symbols = ("cs",)
    units = ("N·m",)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column exp(−(v / velocity)²) z."""
        self.direction(motion, out[0])
        out[0] *= np.exp(-((motion.v / self.velocity) ** 2))


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
    nonnegative = ("mu", "mu_drive", "mu_back")

    @property
    def symbols(self) -> tuple[str, ...]:
        """Symbol mu, or mu_drive and mu_back."""
        return ("mu_drive", "mu_back") if self.split else ("mu",)

    @property
    def units(self) -> tuple[str, ...]:
        """Dimensionless."""
        return ("1",) * len(self.symbols)

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the column |τ_rb| z, or its driving and its back-driving part."""
        self.direction(motion, out[0])
        if self.split:
            outwards = out[0] * np.sign(motion.load)
            np.multiply(out[0], 0.5 * (1.0 - outwards), out=out[1])
            out[0] *= 0.5 * (1.0 + outwards)
        out *= np.abs(motion.load)
