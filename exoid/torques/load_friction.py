"""Load-dependent friction of gears."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

from .term import JointMotion
from .terms import DryFriction


@dataclass(frozen=True, kw_only=True)
class LoadFriction(DryFriction):
    """Load-dependent friction, τ = mu |τ_rb| z, proportional to the torque that a gear carries.

    τ_rb is the rigid-body torque of the *model* at its own parameters, so the fit alternates between them and mu. The
    measured torque cannot take its place: it contains the friction and would predict itself.

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
