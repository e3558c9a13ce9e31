"""Friction of gears, which grows with the torque that they carry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

from .dry_friction import DryFriction
from .motion import JointMotion


@dataclass(frozen=True, kw_only=True)
class LoadFriction(DryFriction):
    """Friction proportional to the torque through the joint, τ = mu |τ_rb| z.

    τ_rb is the rigid-body torque of the *model* at its own parameters, which the fit therefore finds in turn with mu.
    The measured torque, which contains the friction itself, must not stand there: it would predict itself.

    A gear that drives its load loses another share than one that is driven by it. With ``split``, power τ_rb v that
    goes out to the leg has the coefficient mu_drive, power that comes back mu_back:
    τ = |τ_rb| z (mu_drive (1 + z sgn τ_rb) + mu_back (1 − z sgn τ_rb)) / 2, which changes with z and does not jump.
    Since |τ_rb| z² sgn τ_rb is τ_rb while the joint slides, half the difference mu_drive − mu_back only scales the
    rigid-body torque of the joint. At a single joint, or at all at once, inertias absorb that, and only reversals tell
    the two apart: predictions gain, single parameters become uncertain, and the estimate says so.

    Attributes:
        split: Whether driving and back-driving have coefficients of their own.
    """

    split: bool = False

    @property
    def loaded(self) -> bool:
        """It depends on the rigid-body torque."""
        return True

    @property
    def symbols(self) -> tuple[str, ...]:
        """Return mu, or mu_drive and mu_back."""
        return ("mu_drive", "mu_back") if self.split else ("mu",)

    @property
    def units(self) -> tuple[str, ...]:
        """Pure numbers."""
        return ("1",) * len(self.symbols)

    @property
    def nonnegative(self) -> tuple[str, ...]:
        """Return mu."""
        return self.symbols

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Column |τ_rb| z, or its driving and its back-driving share."""
        self.direction(motion, out[0])
        if self.split:
            outwards = out[0] * np.sign(motion.load)
            np.multiply(out[0], 0.5 * (1.0 - outwards), out=out[1])
            out[0] *= 0.5 * (1.0 + outwards)
        out *= np.abs(motion.load)
