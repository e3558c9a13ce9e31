"""Motor: from the current of an electric motor to the torque behind its gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg

from .drive import UnknownConstant, is_number, refuse_unless

SLOW = 0.02
"""Velocity over which the efficiency changes from one direction of power to the other [rad/s]."""

EFFICIENCY_STEP = 1e-4
"""Relative step of differences by the efficiency."""

TORQUE_CONSTANT = UnknownConstant("kt", "N·m/A", 0.1, 1e-6, 1e6, is_scale=True)
EFFICIENCY = UnknownConstant("eta", "1", 0.8, 0.05, 1.0)

REFERENCE = 25.0
"""Temperature of the torque constant where no other is given [°C]."""

LARGEST_COEFFICIENT = 0.01
"""Largest temperature coefficient of a torque constant [1/K]; that of magnets is −0.0005 to −0.002."""

BEYOND_LIMIT = 1.2
"""Currents up to so many times the motor's largest are believed: a controller may overshoot for an instant."""


@dataclass(frozen=True)
class Motor:
    """Electric motor with a gear, measured by its current.

    τ = ratio · η^±1 · k_t · i (doc. 2 computes its torque so, without η). Where the motor drives the joint, τ q̇ > 0,
    the gear passes on the part η of the power: τ = η · ratio · k_t · i. Where the joint drives the motor, it passes on
    the part η_back: τ = ratio · k_t · i / η_back. Around standstill, the factor changes from one to the other as
    tanh(q̇ / :data:`SLOW`) does.

    The torque accelerates the rotor too: its reflected inertia I_a = ratio² · rotor_inertia is the parameter ``Ia`` of
    :class:`exoid.Armature`. ``identify`` holds it if the rotor inertia is given.

    Magnets get weaker as they warm up. With a temperature coefficient α, the torque constant is k_t (1 + α (T − T0)).
    T is the column ``temp_<joint>`` of the recording, which has to have it then. exoid does not identify α.

    Attributes:
        torque_constant: Torque constant k_t [N·m/A]; None to identify it as ``kt_<joint>`` (docs/amperes.md).
        ratio: Gear ratio, motor angle per joint angle; negative if both turn in opposite directions.
        efficiency: Efficiency η of the gear where the motor drives, in (0, 1]; None to identify it as ``eta_<joint>``.
        back_efficiency: Efficiency where the joint drives the motor, in (0, 1]; None for the same.
        rotor_inertia: Inertia of the rotor about its own axis [kg·m²]; None to identify I_a.
        max_current: Largest current [A]; None for no limit.
        temperature_coefficient: Temperature coefficient α of the torque constant [1/K], such as −0.001; None for a
            torque constant that does not depend on temperature.
        reference_temperature: Temperature T0 at which the torque constant is k_t [°C]; None for :data:`REFERENCE`.

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
    temperature_coefficient: float | None = None
    reference_temperature: float | None = None

    channel = "current"
    unit = "A"

    def __post_init__(self) -> None:
        """Check the constants."""
        for name in ("torque_constant", "max_current"):
            value = getattr(self, name)
            valid = value is None or (is_number(value) and value > 0.0)
            refuse_unless(valid, f"Motor({name}={value!r})", "a positive number, or None")
        refuse_unless(
            is_number(self.ratio) and self.ratio != 0.0,
            f"Motor(ratio={self.ratio!r})",
            "motor angle per joint angle, not zero",
        )
        for name in ("efficiency", "back_efficiency"):
            value = getattr(self, name)
            valid = value is None or (is_number(value) and 0.0 < value <= 1.0)
            refuse_unless(valid, f"Motor({name}={value!r})", "a share above 0 and up to 1, such as 0.85 for 85 %")
        inertia = self.rotor_inertia
        refuse_unless(
            inertia is None or (is_number(inertia) and inertia >= 0.0),
            f"Motor(rotor_inertia={inertia!r})",
            "a number of kg·m², zero or positive, or None",
        )
        alpha, reference = self.temperature_coefficient, self.reference_temperature
        refuse_unless(
            alpha is None or (is_number(alpha) and abs(alpha) <= LARGEST_COEFFICIENT),
            f"Motor(temperature_coefficient={alpha!r})",
            "a number per kelvin, such as -0.001 for -0.1 % per kelvin, or None",
        )
        refuse_unless(
            reference is None or (is_number(reference) and -60.0 <= reference <= 220.0),
            f"Motor(reference_temperature={reference!r})",
            "a temperature in °C, such as 25, or None",
        )
        refuse_unless(
            reference is None or alpha is not None,
            "Motor with a reference_temperature and no temperature_coefficient",
            "give both, or leave the temperature out",
        )

    @property
    def needs_velocity(self) -> bool:
        """Whether the gear loses power, so that torque depends on the direction of power."""
        return self.efficiency is None or min(self.efficiency, self.back_efficiency or 1.0) < 1.0

    @property
    def armature(self) -> float | None:
        """Rotor inertia reflected to the joint, I_a = ratio² · rotor_inertia [kg·m²]; None if it is not known."""
        return None if self.rotor_inertia is None else self.ratio**2 * self.rotor_inertia

    def temperature_factor(self, temperature: FloatArray) -> FloatArray:
        """Compute the torque constant over that at the reference temperature, 1 + α (T − T0).

        Args:
            temperature: Temperatures T [°C], any shape.

        Returns:
            The factor, of the same shape; ones without a temperature coefficient.
        """
        alpha = 0.0 if self.temperature_coefficient is None else self.temperature_coefficient
        reference = REFERENCE if self.reference_temperature is None else self.reference_temperature
        return np.asarray(1.0 + alpha * (np.asarray(temperature) - reference))

    def at_temperature(self, temperature: float) -> Motor:
        """Take the torque constant of one temperature, for control and C, where none is measured.

        Args:
            temperature: The temperature [°C].

        Returns:
            The motor with that torque constant, which does not depend on temperature any more.

        Raises:
            ExoidError: The temperature is no finite number, or the torque constant is not known.

        Example:
            >>> Motor(0.1, temperature_coefficient=-0.001).at_temperature(75.0).torque_constant
            0.095
        """
        refuse_unless(is_number(temperature), f"a temperature of {temperature!r}", "a number of °C")
        factor = float(self.temperature_factor(np.array(temperature)))
        constant = self._known_constant() * factor
        return replace(self, torque_constant=constant, temperature_coefficient=None, reference_temperature=None)

    def on(self, leg: Leg, joint: str) -> Motor:
        """Mount the motor, which needs nothing of the leg.

        Args:
            leg: Not used.
            joint: Not used.

        Returns:
            The same motor.
        """
        return self

    @property
    def gear_factors(self) -> tuple[float, float]:
        """Factors of the gear where the motor drives, η, and where it is driven, 1 / η_back.

        Raises:
            ExoidError: The efficiency is not known.
        """
        driving = self._known_efficiency()
        return driving, 1.0 / (driving if self.back_efficiency is None else self.back_efficiency)

    def gear_factor(self, direction: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the factor of the gear: η where the motor drives, 1 / η_back where it is driven.

        Args:
            direction: Anything with the sign of the torque, (N,).
            v: Joint velocities [rad/s], (N,).

        Returns:
            The factor, between both near standstill, (N,).

        Raises:
            ExoidError: The efficiency is not known.
        """
        driving, driven = self.gear_factors
        power = np.tanh(np.sign(direction) * v / SLOW)
        return np.asarray(0.5 * (driving + driven) + 0.5 * (driving - driven) * power)

    def torque(
        self, reading: FloatArray, q: FloatArray, v: FloatArray, direction: FloatArray | None = None
    ) -> FloatArray:
        """Compute the torque at the joint, τ = ratio · η^±1 · k_t · i.

        Args:
            reading: Motor currents i [A], (N,).
            q: Not used.
            v: Joint velocities [rad/s], (N,); only their sign matters, and only if the gear loses power.
            direction: Currents without noise [A], whose sign tells the direction of power, (N,); None for ``reading``.

        Returns:
            Torques at the reference temperature [N·m], (N,).

        Raises:
            ExoidError: The torque constant is not known, or currents are beyond the motor's largest.
        """
        largest = float(np.abs(reading).max(initial=0.0))
        if self.max_current is not None and largest > BEYOND_LIMIT * self.max_current:
            raise ExoidError(
                f"a current of {largest:.4g} A, and max_current of the motor is {self.max_current:g} A",
                remedy="read currents in amperes (a column in mA has the unit mA), or correct max_current",
            )
        ideal = self.ratio * self._known_constant() * reading
        if not self.needs_velocity:
            return ideal
        return ideal * self.gear_factor(ideal if direction is None else self.ratio * direction, v)

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the current that makes a torque at the joint, at most :attr:`max_current`.

        Args:
            torque: Requested torques [N·m], (N,).
            q: Not used.
            v: Joint velocities [rad/s], (N,).

        Returns:
            Currents at the reference temperature [A], (N,).

        Raises:
            ExoidError: The torque constant is not known.
        """
        current = torque / (self.ratio * self._known_constant())
        if self.needs_velocity:
            current = current / self.gear_factor(torque, v)
        limit = np.inf if self.max_current is None else self.max_current
        return np.asarray(np.clip(current, -limit, limit))

    @property
    def unknown(self) -> tuple[UnknownConstant, ...]:
        """Torque constant kt and efficiency eta, where they are not known."""
        given = ((TORQUE_CONSTANT, self.torque_constant), (EFFICIENCY, self.efficiency))
        return tuple(constant for constant, value in given if value is None)

    def with_constants(self, values: Mapping[str, float]) -> Motor:
        """Replace constants by values.

        Args:
            values: Value by symbol, "kt" [N·m/A] and "eta".

        Returns:
            The motor.

        Raises:
            ExoidError: A value is impossible.
        """
        fields = {"kt": "torque_constant", "eta": "efficiency"}
        return replace(self, **{fields[symbol]: value for symbol, value in values.items()})

    def sensitivity(self, symbol: str, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Differentiate the torque by a constant while the current stays, ∂τ/∂k_t = τ/k_t and ∂τ/∂η.

        Args:
            symbol: "kt" or "eta".
            torque: Torques [N·m], (N,).
            q: Not used.
            v: Joint velocities [rad/s], (N,).

        Returns:
            Derivative [N·m per unit of the constant], (N,).

        Raises:
            ExoidError: The constant is not known.
        """
        if symbol == "kt":
            return torque / self._known_constant()
        step = EFFICIENCY_STEP * self._known_efficiency()
        lower, upper = (replace(self, efficiency=self._known_efficiency() - x) for x in (2.0 * step, 0.0))
        middle = replace(self, efficiency=self._known_efficiency() - step)
        below, at, above = (motor.gear_factor(torque, v) for motor in (lower, middle, upper))
        slope = (3.0 * above - 4.0 * at + below) / (2.0 * step)  # one-sided: no efficiency is above 1
        return torque * slope / above

    def _known_efficiency(self) -> float:
        if self.efficiency is None:
            raise ExoidError(
                "the efficiency of the gear is not known, so that the current is no torque",
                remedy="give efficiency, such as that of its data sheet; exoid.identify finds it",
            )
        return self.efficiency

    def _known_constant(self) -> float:
        if self.torque_constant is None:
            raise ExoidError(
                "the torque constant of the motor is not known, so that its current is no torque",
                remedy="give torque_constant in N·m/A, such as that of its data sheet; exoid.identify finds it if some "
                "recordings have a payload that was weighed",
            )
        return self.torque_constant
