"""Reference motion of a machine on the ground, and what holds its torso."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked


@dataclass(frozen=True, eq=False, repr=False)
class GroundMotion:
    """Reference of joints and torso at K times.

    Attributes:
        time: Times [s], (K,), increasing. Samples before time zero let the machine settle, and are not logged.
        q: Joint angles [rad], (K, n).
        torque: Feed-forward torque of the actuators [N·m], (K, n).
        base: Position forward and up [m] and pitch [rad] of the root link's origin, (K, 3); pitch is positive about
            −lateral: the shoulders move backwards.

    Raises:
        ExoidError: Shapes do not fit, or a number is missing.
    """

    time: FloatArray
    q: FloatArray
    torque: FloatArray
    base: FloatArray

    def __post_init__(self) -> None:
        """Check shapes and numbers."""
        shapes = {field.name: getattr(self, field.name).shape for field in fields(self)}
        K = len(self.time)
        if K < 2 or shapes["q"] != shapes["torque"] or shapes["q"][:1] != (K,) or shapes["base"] != (K, 3):
            raise BadArgumentError(f"a motion of shapes {shapes}", remedy="give (K,), (K, n), (K, n) and (K, 3)")
        if not all(np.isfinite(getattr(self, field.name)).all() for field in fields(self)):
            raise BadArgumentError(
                "the reference motion is not finite", remedy="keep the feet within reach of the legs"
            )

    def at(self, time: FloatArray) -> JointTargets:
        """Interpolate by cubic splines at M times."""
        joints, torque, base = (scipy.interpolate.CubicSpline(self.time, x) for x in (self.q, self.torque, self.base))
        return JointTargets(joints(time), joints(time, 1), torque(time), base(time), base(time, 1))


@dataclass(frozen=True, eq=False, repr=False)
class JointTargets:
    """Reference at the times of a controller."""

    q: FloatArray  # joint angles [rad], (M, n)
    v: FloatArray  # joint velocities [rad/s], (M, n)
    torque: FloatArray  # feed-forward torque [N·m], (M, n)
    base: FloatArray  # position forward and up [m] and pitch [rad] of the root link's origin, (M, 3)
    base_rate: FloatArray  # its rate, (M, 3)


@dataclass(frozen=True)
class JointGains:
    """Gains of the controller, τ = feed-forward + stiffness (q_ref − q) + damping (v_ref − v), limited by the URDF.

    Attributes:
        stiffness: Stiffness [N·m/rad]: a number, one a joint, or one for each joint of a leg, repeated for every leg.
        damping: Damping [N·m·s/rad], likewise.
    """

    stiffness: tuple[float, ...] | float
    damping: tuple[float, ...] | float


@dataclass(frozen=True)
class Spring:
    """Spring and damper between a point of the torso and a carriage that moves as the reference: hand rail, harness.

    Attributes:
        point: Point of the torso in the axes of the root link [m], (3,).
        stiffness: Stiffness along forward, lateral and up [N/m].
        damping: Damping along them [N·s/m].
        turning_stiffness: Stiffness against rotation [N·m/rad].
        turning_damping: Damping of rotation [N·m·s/rad].

    Raises:
        ExoidError: A number is negative or not finite.
    """

    point: tuple[float, float, float]
    stiffness: tuple[float, float, float]
    damping: tuple[float, float, float]
    turning_stiffness: float = 0.0
    turning_damping: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        constants = [*self.stiffness, *self.damping, self.turning_stiffness, self.turning_damping]
        checked(constants, "stiffness or damping of a Spring", least=0.0)
        checked(self.point, "the point of a Spring")


def per_joint(values: tuple[float, ...] | float, n: int, name: str) -> FloatArray:
    """Repeat numbers for n joints."""
    numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if numbers.ndim != 1 or not len(numbers) or n % len(numbers):
        raise BadArgumentError(f"{name} has {numbers.size} values for {n} joints", remedy="give one, or one a joint")
    return np.tile(checked(numbers, name, least=0.0), n // len(numbers))
