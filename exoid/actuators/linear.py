"""Linear actuator: from the force of a cylinder or spindle to the torque of the joint that it turns."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg

from .attachments import SHORTEST, MomentArm
from .drive import Drive, UnknownConstant, check_constant, refuse_beyond


@dataclass(frozen=True)
class LinearActuator(Drive):
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
    constants = (UnknownConstant("kf", "gain", "1", 1.0, 1e-6, 1e6, is_scale=True),)

    def __post_init__(self) -> None:
        """Check largest force, gain and moment arm."""
        check_constant(self, "max_force", lambda value: value > 0.0, "a positive number of N, or None")
        check_constant(self, "gain", lambda value: value > 0.0, "a positive number near 1, or None")
        if not isinstance(self.moment_arm, MomentArm):
            what = f"LinearActuator(moment_arm={self.moment_arm!r})"
            raise BadArgumentError(what, remedy="exoid.actuators.Attachments or MomentArmTable")

    def on(self, leg: Leg, joint: str) -> LinearActuator:
        """Mount the actuator with the geometry of its attachment points."""
        return replace(self, moment_arm=self.moment_arm.on(leg, joint))

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """τ = g r(q) F."""
        unit = "read forces in newtons (give the column its unit, such as kN), or correct max_force"
        refuse_beyond(self, "max_force", reading, unit)
        return self.known("gain") * self.moment_arm.arm(q) * reading

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """F = τ / (g r(q)), at most :attr:`max_force`."""
        arm = self.moment_arm.arm(q)
        if (np.abs(arm) < SHORTEST).any():
            dead = float(q[int(np.abs(arm).argmin())])
            raise BadArgumentError(
                f"the actuator has no moment arm at {dead:.4g} rad (dead centre), so that no force makes a torque",
                remedy="keep the motion away from this angle",
            )
        limit = np.inf if self.max_force is None else self.max_force
        return np.asarray(np.clip(torque / (self.known("gain") * arm), -limit, limit))
