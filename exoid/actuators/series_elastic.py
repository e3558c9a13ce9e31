"""Series elastic actuator: from the deflection of a spring to the torque of a joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg

from .drive import is_number, refuse_unless

LARGEST_DEFLECTION = 1.0
"""Largest range of a spring's deflection that is believed [rad]."""


@dataclass(frozen=True)
class SeriesElastic:
    """Motor behind a spring, measured by its own angle: τ = k (θ_m / ratio − q).

    The spring has no mass, so that the rotor's inertia and the friction of motor and gear are not part of the torque.

    Attributes:
        stiffness: Stiffness k of the spring at the joint [N·m/rad].
        ratio: Gear ratio, motor angle per angle behind the spring; negative if both turn in opposite directions.

    Raises:
        ExoidError: The stiffness is not positive, or the ratio is zero.

    Example:
        >>> drive = SeriesElastic(300.0, ratio=50.0)
        >>> print(f"{drive.torque(np.array([25.0]), np.array([0.4]), np.array([0.0]))[0]:.0f} N·m")
        30 N·m
    """

    stiffness: float
    ratio: float = 1.0

    channel = "motor_angle"
    unit = "rad"
    needs_velocity = False

    def __post_init__(self) -> None:
        """Check the constants."""
        refuse_unless(
            is_number(self.stiffness) and self.stiffness > 0.0,
            f"SeriesElastic(stiffness={self.stiffness!r})",
            "a positive number of N·m/rad",
        )
        refuse_unless(
            is_number(self.ratio) and self.ratio != 0.0,
            f"SeriesElastic(ratio={self.ratio!r})",
            "motor angle per joint angle, not zero",
        )

    def on(self, leg: Leg, joint: str) -> SeriesElastic:
        """Mount the drive, which needs nothing of the leg.

        Args:
            leg: Not used.
            joint: Not used.

        Returns:
            The same drive.
        """
        return self

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque of the spring, τ = k (θ_m / ratio − q).

        Args:
            reading: Motor angles θ_m [rad], (N,).
            q: Joint angles [rad], (N,).
            v: Not used.

        Returns:
            Torques [N·m], (N,).

        Raises:
            ExoidError: The motor does not follow the joint, as if the ratio, a sign or a unit were wrong.
        """
        deflection = reading / self.ratio - q
        spread = float(np.ptp(deflection)) if len(deflection) else 0.0
        if spread > LARGEST_DEFLECTION:
            raise ExoidError(
                f"the spring's deflection θ_m / ratio − q spans {spread:.3g} rad",
                remedy="check ratio, sign and unit of the motor angle, which is in rad in front of the gear",
            )
        return self.stiffness * deflection

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the motor angle that makes a torque at the joint, θ_m = ratio (q + τ / k).

        Args:
            torque: Requested torques [N·m], (N,).
            q: Joint angles [rad], (N,).
            v: Not used.

        Returns:
            Motor angles [rad], (N,).
        """
        return self.ratio * (q + torque / self.stiffness)
