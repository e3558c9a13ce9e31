"""Series elastic actuator: from the deflection of a spring to the torque of a joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .drive import Drive, check_constant


@dataclass(frozen=True)
class SeriesElastic(Drive):
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

    def __post_init__(self) -> None:
        """Check the constants."""
        check_constant(self, "stiffness", lambda value: value > 0.0, "a positive number of N·m/rad", optional=False)
        check_constant(self, "ratio", bool, "motor angle per joint angle, not zero", optional=False)

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """τ = k (θ_m / ratio − q)."""
        deflection = reading / self.ratio - q
        spread = float(np.ptp(deflection)) if deflection.size else 0.0
        # Largest range of a spring's deflection that is believed [rad]
        if spread > 1.0:
            raise BadArgumentError(
                f"the spring's deflection θ_m / ratio − q spans {spread:.3g} rad",
                remedy="check ratio, sign and unit of the motor angle, which is in rad in front of the gear",
            )
        return self.stiffness * deflection

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """θ_m = ratio (q + τ / k)."""
        return self.ratio * (q + torque / self.stiffness)
