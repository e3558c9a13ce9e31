"""Limits of a planned motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg

from .clearance import Clearance

MARGIN = np.deg2rad(3.0)
"""Margin to the joint limits of the URDF for overshoot of the servos [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class MotionLimits:
    """Limits of each joint, (n,) each, and clearance of the foot.

    Attributes:
        lower: Smallest angle [rad].
        upper: Largest angle [rad].
        velocity: Largest speed [rad/s].
        acceleration: Largest acceleration [rad/s²]; inf for none.
        torque: Largest torque [N·m]; inf for none.
        clearance: Clearance of the foot; None for none.

    Raises:
        ExoidError: A limit is not positive, or a lower limit is not below the upper one.
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    clearance: Clearance | None = None

    def __post_init__(self) -> None:
        """Check the limits."""
        if not (self.lower < self.upper).all() or not np.isfinite([self.lower, self.upper]).all():
            joint = int(np.argmin(self.upper - self.lower))
            raise ExoidError(
                f"no range between the limits of joint {joint}: {np.rad2deg(self.lower[joint]):.1f}° to "
                f"{np.rad2deg(self.upper[joint]):.1f}°",
                remedy="give a lower limit below the upper one, both finite, or a smaller margin",
            )
        for name in ("velocity", "acceleration", "torque"):
            if not (getattr(self, name) > 0.0).all():
                raise ExoidError(f"a {name} limit is not positive", remedy="give positive limits, or inf for none")

    def __repr__(self) -> str:
        """Write the limits of all joints."""
        lower, upper = np.rad2deg([self.lower, self.upper])
        angles = ", ".join(f"{low:.3g} to {high:.3g}" for low, high in zip(lower, upper, strict=True))
        others = (("velocity", "rad/s"), ("acceleration", "rad/s²"), ("torque", "N·m"))
        texts = [f"{name} {', '.join(f'{x:.3g}' for x in getattr(self, name))} {unit}" for name, unit in others]
        return f"MotionLimits(angle {angles} deg; {'; '.join(texts)}; clearance {self.clearance})"

    @classmethod
    def of(
        cls,
        leg: Leg,
        *,
        margin: float = MARGIN,
        angles_deg: Mapping[str, tuple[float, float]] | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        clearance: Clearance | None = None,
    ) -> MotionLimits:
        """Take the limits of the URDF, narrowed by given ones.

        Args:
            leg: Leg with the limits of its URDF; continuous joints get ±180°.
            margin: Margin to these limits [rad].
            angles_deg: Narrower ranges of angle by joint name or label [deg].
            velocity: Largest speed [rad/s], a number or (n,).
            acceleration: Largest acceleration [rad/s²], a number or (n,).
            torque: Largest torque [N·m], a number or (n,).
            clearance: Clearance of the foot; None for none.

        Returns:
            Limits of a planned motion.

        Raises:
            ExoidError: A joint is unknown, no range of angle remains, or a limit has the wrong size or sign.
        """
        own, n = leg.limits, len(leg.joint_names)
        lower = np.where(np.isfinite(own.lower), own.lower, -np.pi) + margin
        upper = np.where(np.isfinite(own.upper), own.upper, np.pi) - margin
        for name, (low, high) in (angles_deg or {}).items():
            joint = joint_index(leg, name)
            lower[joint] = max(lower[joint], np.deg2rad(low))
            upper[joint] = min(upper[joint], np.deg2rad(high))
        given = {"velocity": velocity, "acceleration": acceleration, "torque": torque}
        urdf = {"velocity": own.velocity, "acceleration": np.full(n, np.inf), "torque": own.effort}
        chosen = {key: np.minimum(_stated(urdf[key]), _each(value, n, key)) for key, value in given.items()}
        return cls(lower, upper, **chosen, clearance=clearance)

    @property
    def span(self) -> FloatArray:
        """Range of angle [rad], (n,)."""
        return self.upper - self.lower


def joint_index(leg: Leg, name: str) -> int:
    """Find a joint by its name or label."""
    for names in (leg.joint_names, leg.joint_labels):
        if name in names:
            return names.index(name)
    raise ExoidError(f"no joint {name!r} in the leg", remedy=f"its joints are {', '.join(leg.joint_names)}")


def _stated(limit: FloatArray) -> FloatArray:
    """Limits of a URDF, in which zero means no limit."""
    return np.where(limit > 0.0, limit, np.inf)


def _each(value: ArrayLike | None, n: int, name: str) -> FloatArray:
    try:
        return np.broadcast_to(np.inf if value is None else np.asarray(value, dtype=np.float64), (n,))
    except ValueError as error:
        raise ExoidError(
            f"{name} limits of {np.size(np.asarray(value))} joints for a leg of {n}",
            remedy="give one number, or one for each joint",
        ) from error
