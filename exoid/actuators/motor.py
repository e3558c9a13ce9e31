"""Motor: from the current of an electric motor to the torque behind its gear."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.torques.terms import SIGN_WIDTH

from .drive import Drive, UnknownConstant, check_constant, refuse_beyond


@dataclass(frozen=True)
class Motor(Drive):
    """Electric motor with a gear, measured by its current.

    τ = ratio · η^±1 · k_t · i (doc. 2 computes its torque so, without η). Where the motor drives the joint, τ q̇ > 0,
    the gear passes on the part η of the power: τ = η · ratio · k_t · i. Where the joint drives the motor, it passes on
    the part η_back: τ = ratio · k_t · i / η_back. Around standstill, the factor changes from one to the other as
    tanh(q̇ / 0.02 rad/s) does.

    The torque accelerates the rotor too: its reflected inertia I_a = ratio² · rotor_inertia is the parameter ``Ia`` of
    :class:`exoid.Armature`. ``identify`` holds it if the rotor inertia is given.

    Attributes:
        torque_constant: Torque constant k_t [N·m/A]; None to identify it as ``kt_<joint>`` (docs/amperes.md).
        ratio: Gear ratio, motor angle per joint angle; negative if both turn in opposite directions.
        efficiency: Efficiency η of the gear where the motor drives, in (0, 1]; None to identify it as ``eta_<joint>``.
        back_efficiency: Efficiency where the joint drives the motor, in (0, 1]; None for the same.
        rotor_inertia: Inertia of the rotor about its own axis [kg·m²]; None to identify I_a.
        max_current: Largest current [A]; None for no limit.

    Raises:
        ExoidError: A constant is not finite or has an impossible value.

    Example:
        >>> motor = Motor(0.07, ratio=50.0, efficiency=0.85)
        >>> driving, driven = motor.torque(np.array([2.0, 2.0]), np.zeros(2), np.array([1.0, -1.0]))
        >>> print(f"{driving:.2f} N·m while it drives, {driven:.2f} N·m while it is driven")
        5.95 N·m while it drives, 8.24 N·m while it is driven
    """

    torque_constant: float | None
    ratio: float = 1.0
    efficiency: float | None = 1.0
    back_efficiency: float | None = None
    rotor_inertia: float | None = None
    max_current: float | None = None

    channel = "current"
    unit = "A"
    constants = (
        UnknownConstant("kt", "torque_constant", "N·m/A", 0.1, 1e-6, 1e6, is_scale=True),
        UnknownConstant("eta", "efficiency", "1", 0.8, 0.05, 1.0),
    )

    def __post_init__(self) -> None:
        """Check the constants."""
        for name in ("torque_constant", "max_current"):
            check_constant(self, name, lambda value: value > 0.0, "a positive number, or None")
        check_constant(self, "ratio", bool, "motor angle per joint angle, not zero", optional=False)
        for name in ("efficiency", "back_efficiency"):
            share = "a share above 0 and up to 1, such as 0.85 for 85 %"
            check_constant(self, name, lambda value: 0.0 < value <= 1.0, share)
        check_constant(
            self, "rotor_inertia", lambda value: value >= 0.0, "a number of kg·m², zero or positive, or None"
        )

    @property
    def needs_velocity(self) -> bool:  # type: ignore[override]
        """Whether the gear loses power, so that torque depends on the direction of power."""
        return self.efficiency is None or min(self.efficiency, self.back_efficiency or 1.0) < 1.0

    @property
    def armature(self) -> float | None:
        """Rotor inertia reflected to the joint, I_a = ratio² · rotor_inertia [kg·m²]; None if it is not known."""
        return None if self.rotor_inertia is None else self.ratio**2 * self.rotor_inertia

    @property
    def gear_factors(self) -> tuple[float, float]:
        """Factors of the gear where the motor drives, η, and where it is driven, 1 / η_back.

        Raises:
            ExoidError: The efficiency is not known.
        """
        driving = self.known("efficiency")
        return driving, 1.0 / (driving if self.back_efficiency is None else self.back_efficiency)

    def torque(
        self, reading: FloatArray, q: FloatArray, v: FloatArray, direction: FloatArray | None = None
    ) -> FloatArray:
        """τ = ratio · η^±1 · k_t · i; ``direction`` are currents without noise, whose sign tells that of the power."""
        unit = "read currents in amperes (a column in mA has the unit mA), or correct max_current"
        refuse_beyond(self, "max_current", reading, unit)
        ideal = self.ratio * self.known("torque_constant") * reading
        if not self.needs_velocity:
            return ideal
        return ideal * self._gear_factor(ideal if direction is None else self.ratio * direction, v)

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Current i = τ / (ratio · η^±1 · k_t), at most :attr:`max_current`."""
        current = torque / (self.ratio * self.known("torque_constant"))
        if self.needs_velocity:
            current = current / self._gear_factor(torque, v)
        limit = np.inf if self.max_current is None else self.max_current
        return np.asarray(np.clip(current, -limit, limit))

    def sensitivity(self, symbol: str, torque: FloatArray, v: FloatArray) -> FloatArray:
        """∂τ/∂k_t = τ/k_t, and ∂τ/∂η by differences."""
        if symbol == "kt":
            return super().sensitivity(symbol, torque, v)
        # One-sided differences of second order: no efficiency is above 1.
        efficiency = self.known("efficiency")
        step = 1e-4 * efficiency
        below, at, above = (
            replace(self, efficiency=efficiency - k * step)._gear_factor(torque, v) for k in (2.0, 1.0, 0.0)
        )
        slope = (3.0 * above - 4.0 * at + below) / (2.0 * step)
        return torque * slope / above

    def _gear_factor(self, direction: FloatArray, v: FloatArray) -> FloatArray:
        """η where the motor drives, 1 / η_back where it is driven, between both near standstill."""
        driving, driven = self.gear_factors
        power = np.tanh(np.sign(direction) * v / SIGN_WIDTH)
        return np.asarray(0.5 * (driving + driven) + 0.5 * (driving - driven) * power)
