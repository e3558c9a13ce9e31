"""Friction that depends linearly on temperature."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .term import JointMotion
from .terms import DryFriction


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
            raise ExoidError(
                f"TemperatureFriction(reference={self.reference})", remedy="a temperature in °C, such as 25"
            )

    def fill(self, motion: JointMotion, out: FloatArray) -> None:
        """Write the columns z (T − T0) and q̇ (T − T0)."""
        if motion.temperature is None:
            raise ExoidError(
                "TemperatureFriction needs the temperature of its joint",
                remedy="give the temperature, or identify without this term at the temperature of use",
            )
        warmer = motion.temperature - self.reference
        self.direction(motion, out[0])
        np.multiply(out[0], warmer, out=out[0])
        np.multiply(motion.v, warmer, out=out[1])
