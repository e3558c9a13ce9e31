"""Linear actuator: from the force of a cylinder or spindle to the torque of the joint that it turns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg

from .attachments import SHORTEST
from .drive import UnknownConstant, is_number, refuse_unless

GAIN = UnknownConstant("kf", "1", 1.0, 1e-6, 1e6, is_scale=True)

BEYOND_LIMIT = 1.2
"""Forces up to so many times the largest are believed."""


class MomentArm(Protocol):
    """Length and moment arm of a linear actuator as functions of a joint's angle."""

    def on(self, leg: Leg, joint: str) -> MomentArm:
        """Find the geometry around a joint of a leg.

        Args:
            leg: The leg.
            joint: Name of the joint.

        Returns:
            Length and moment arm there.
        """


class MountedMomentArm(MomentArm, Protocol):
    """Moment arm at a joint."""

    def length(self, q: FloatArray) -> FloatArray:
        """Compute the length l [m], which may lack a constant."""

    def arm(self, q: FloatArray) -> FloatArray:
        """Compute the moment arm r = dl/dq."""


@dataclass(frozen=True)
class LinearActuator:
    """Cylinder or spindle that turns one joint, measured by its force.

    By virtual work τ q̇ = F l̇, so that τ = g r(q) F with the moment arm r = dl/dq (doc. 1 computes its torques so, from
    force, angle and geometry) and a gain g of the force channel, usually 1. The force is positive where it pushes the
    attachment points apart. A load cell that reads tension as positive needs the scale −1. Friction of seals is a force
    at the rod; it appears as joint friction.

    Attributes:
        moment_arm: Two attachment points (:class:`exoid.actuators.Attachments`), or a measured table
            (:class:`exoid.actuators.MomentArmTable`).
        max_force: Largest force [N]; None for no limit.
        gain: Gain g of the force channel, true over measured force; None to identify it as ``kf_<joint>``. A gain of
            the moment arm has the same effect.

    Raises:
        ExoidError: The largest force or the gain is not positive, or the moment arm is something else.

    Example:
        >>> from exoid.actuators import Attachments
        >>> points = Attachments(("thigh", (0.05, 0.0, -0.10)), ("shank", (0.05, 0.0, -0.06)))
        >>> knee = LinearActuator(points).on(exoid.load_leg("cuhk"), "left_knee")
        >>> print(f"{knee.torque(np.array([1000.0]), np.array([0.5]), np.array([0.0]))[0]:.1f} N·m")
        21.8 N·m
    """

    moment_arm: MomentArm
    max_force: float | None = None
    gain: float | None = 1.0

    channel = "force"
    unit = "N"
    needs_velocity = False

    def __post_init__(self) -> None:
        """Check largest force and gain."""
        for name, unit in (("max_force", "of N"), ("gain", "near 1")):
            value = getattr(self, name)
            refuse_unless(
                value is None or (is_number(value) and value > 0.0),
                f"LinearActuator({name}={value!r})",
                f"a positive number {unit}, or None",
            )
        refuse_unless(
            callable(getattr(self.moment_arm, "on", None)),
            f"LinearActuator(moment_arm={self.moment_arm!r})",
            "exoid.actuators.Attachments or MomentArmTable",
        )

    def on(self, leg: Leg, joint: str) -> LinearActuator:
        """Mount the actuator on a joint.

        Args:
            leg: The leg.
            joint: Name of the joint.

        Returns:
            The actuator, with the geometry of its attachment points.

        Raises:
            ExoidError: The attachment points do not fit the joint.
        """
        return replace(self, moment_arm=self.moment_arm.on(leg, joint))

    @property
    def geometry(self) -> MountedMomentArm:
        """Length and moment arm.

        Raises:
            ExoidError: The actuator is not mounted on a leg.
        """
        if not hasattr(self.moment_arm, "arm"):
            raise ExoidError(
                "the attachment points of a linear actuator have no moment arm without their leg",
                remedy='mount it: actuator.on(leg, "left_knee"), or Actuators.of(leg, {"left_knee": actuator})',
            )
        return self.moment_arm  # type: ignore[return-value]

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque at the joint, τ = g r(q) F.

        Args:
            reading: Forces F [N], (N,).
            q: Joint angles [rad], (N,).
            v: Not used.

        Returns:
            Torques [N·m], (N,).

        Raises:
            ExoidError: A force is beyond the largest, an angle beyond the table of moment arms, or the gain not known.
        """
        largest = float(np.abs(reading).max(initial=0.0))
        if self.max_force is not None and largest > BEYOND_LIMIT * self.max_force:
            raise ExoidError(
                f"a force of {largest:.4g} N, and max_force of the actuator is {self.max_force:g} N",
                remedy="read forces in newtons (give the column its unit, such as kN), or correct max_force",
            )
        return self.known_gain * self.geometry.arm(q) * reading

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the force that makes a torque at the joint, F = τ / (g r(q)), at most :attr:`max_force`.

        Args:
            torque: Requested torques [N·m], (N,).
            q: Joint angles [rad], (N,).
            v: Not used.

        Returns:
            Forces [N], (N,).

        Raises:
            ExoidError: The moment arm is below 1 mm at an angle, so that no force makes a torque, or the gain is not
                known.
        """
        arm = self.geometry.arm(q)
        if (np.abs(arm) < SHORTEST).any():
            dead = float(q[int(np.abs(arm).argmin())])
            raise ExoidError(
                f"the actuator has no moment arm at {dead:.4g} rad (dead centre), so that no force makes a torque",
                remedy="keep the motion away from this angle",
            )
        limit = np.inf if self.max_force is None else self.max_force
        return np.asarray(np.clip(torque / (self.known_gain * arm), -limit, limit))

    @property
    def unknown(self) -> tuple[UnknownConstant, ...]:
        """Gain kf, if it is not known."""
        return (GAIN,) if self.gain is None else ()

    def with_constants(self, values: Mapping[str, float]) -> LinearActuator:
        """Replace the gain by a value.

        Args:
            values: Value of "kf".

        Returns:
            The actuator.

        Raises:
            ExoidError: The gain is not positive.
        """
        return replace(self, gain=values["kf"]) if values else self

    def sensitivity(self, symbol: str, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Differentiate the torque by the gain while the force stays, ∂τ/∂g = τ/g.

        Args:
            symbol: "kf".
            torque: Torques [N·m], (N,).
            q: Not used.
            v: Not used.

        Returns:
            Derivative [N·m], (N,).

        Raises:
            ExoidError: The gain is not known.
        """
        return torque / self.known_gain

    @property
    def known_gain(self) -> float:
        """Gain of the force channel.

        Raises:
            ExoidError: It is not known.
        """
        if self.gain is None:
            raise ExoidError(
                "the gain of the force channel is not known, so that its force is no torque",
                remedy="give gain, 1 for a calibrated load cell; exoid.identify finds it if some recordings have a "
                "payload that was weighed",
            )
        return self.gain
