"""Limits of motions: those of a plan, and checks of poses and motions before an experiment runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.description import LARGEST_ANGLE
from exoid.leg.joint_numbers import for_joints
from exoid.leg.leg import Leg
from exoid.rig import Reference
from exoid.tools.numbers import ROUNDED, checked
from exoid.torques.catalog import radians
from exoid.torques.position_units import position_units

MARGIN = np.deg2rad(3.0)
"""Margin to the joint limits of the URDF for overshoot of the servos [rad]; a tenth of it in m of a prismatic joint."""

RANGE = "give a lower limit below the upper one, both finite, or a smaller margin"
"""Remedy for limits without a range between them."""


@dataclass(frozen=True, eq=False, repr=False)
class MotionLimits:
    """Limits of each joint, (n,) each.

    Attributes:
        lower: Smallest angle [rad].
        upper: Largest angle [rad].
        velocity: Largest speed [rad/s].
        acceleration: Largest acceleration [rad/s²]; inf for none.
        torque: Largest torque [N·m]; inf for none.

    Raises:
        ExoidError: A limit is not positive, or a lower limit is not below the upper one.
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray

    def __post_init__(self) -> None:
        """Check the limits."""
        if not (self.lower < self.upper).all() or not np.isfinite([self.lower, self.upper]).all():
            raise BadArgumentError("a joint has no range between its limits", remedy=RANGE)
        for name in ("velocity", "acceleration", "torque"):
            checked(getattr(self, name), f"a {name} limit", above=0.0, infinite=True)

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
    ) -> MotionLimits:
        """Take the limits of the URDF, narrowed by given ones, and to where closed loops close.

        Args:
            leg: Leg with the limits of its URDF; continuous joints get ±180°.
            margin: Margin to these limits [rad]; 0.1 m of a prismatic joint counts as 1 rad.
            angles_deg: Narrower ranges of angle by joint name or label [deg, of prismatic joints mm].
            velocity: Largest speed [rad/s], a number or (n,).
            acceleration: Largest acceleration [rad/s²], a number or (n,).
            torque: Largest torque [N·m], a number or (n,).

        Returns:
            Limits of a planned motion.

        Raises:
            ExoidError: A joint is unknown, no range of angle remains, or a limit has the wrong size or sign.
        """
        own, n, given = leg.limits, len(leg.joint_names), angles_deg or {}
        for k, names in enumerate(zip(leg.joint_names, leg.joint_labels, strict=True)):
            ends = own.lower[k], own.upper[k]
            odd = leg.model.joints[k + 1].nq == 1 and not max(map(abs, ends)) < 1.01 * LARGEST_ANGLE  # none, or degrees
            if odd and given.keys().isdisjoint(names):
                raise BadArgumentError(
                    "the URDF has no limits in rad or m of joint {!r}, but {:.4g} to {:.4g}".format(names[0], *ends),
                    remedy=f"give the range that is safe, in degrees or mm: angles_deg={{{names[0]!r}: (low, high)}}",
                    command=f"give the range that is safe, in degrees or mm: --angles {names[0]}=LOW:HIGH",
                    joints=(names[0],),
                )
        gap = margin * radians(leg)
        lower = np.where(np.isfinite(own.lower), own.lower, -np.pi) + gap
        upper = np.where(np.isfinite(own.upper), own.upper, np.pi) - gap
        for name, (low, high) in given.items():
            if name not in (*leg.joint_names, *leg.joint_labels):
                known = ", ".join(leg.joint_names)
                raise BadArgumentError(f"no joint {name!r} in the leg", remedy=f"its joints are {known}")
            joint = (*leg.joint_names, *leg.joint_labels).index(name) % n
            size = position_units(leg)[joint].size
            lower[joint] = max(lower[joint], low * size)
            upper[joint] = min(upper[joint], high * size)
        if leg.closure is not None:
            lower, upper = leg.closure.closing(lower, upper)
        for joint in np.flatnonzero(~(lower < upper))[:1]:
            low, high = map(position_units(leg)[joint].show, (lower[joint], upper[joint]))
            what = f"no range between the limits of {leg.joint_names[joint]}: {low} to {high}"
            raise BadArgumentError(what, remedy=RANGE)
        speed, change, effort = (
            for_joints(np.inf if x is None else x, n, f"{name} limits")
            for name, x in (("velocity", velocity), ("acceleration", acceleration), ("torque", torque))
        )
        return cls(lower, upper, np.minimum(own.velocity, speed), change, np.minimum(own.effort, effort))

    @property
    def span(self) -> FloatArray:
        """Range of angle [rad], (n,)."""
        return self.upper - self.lower


def refuse_poses_beyond_limits(leg: Leg, poses: ArrayLike) -> None:
    """Refuse poses that a joint cannot reach."""
    angles = np.asarray(poses, dtype=np.float64)
    if angles.ndim != 2 or angles.shape[1] != len(leg.joint_names) or not len(angles):
        raise BadArgumentError(
            f"poses of shape {angles.shape}",
            where=leg.description.name,
            remedy=f"pass one row a pose and one column for each of {', '.join(leg.joint_names)}",
        )
    lower, upper, *_ = leg.limits
    beyond = _beyond(angles, lower, upper)
    if len(beyond):
        pose, joint = beyond[0]
        show = position_units(leg)[joint].show
        raise BadArgumentError(
            f"pose {pose} asks {leg.joint_names[joint]} for {show(angles[pose, joint])}",
            where=leg.description.name,
            remedy=f"stay between {show(lower[joint])} and {show(upper[joint])}",
        )


def refuse_motion_beyond_limits(leg: Leg, reference: Reference, duration: float) -> None:
    """Refuse a motion that exceeds the limits of angle or speed."""
    checked(duration, "the duration of the motion [s]", above=0.0)
    time = np.arange(0.0, duration + 0.005, 0.01)
    targets = [reference.at(float(t)) for t in time]
    q, v = np.array([target.q for target in targets]), np.array([target.v for target in targets])
    if q.ndim != 3 or q.shape[1] != len(leg.joint_names):
        raise BadArgumentError(
            f"a motion of shape {q.shape[1:]}",
            where=leg.description.name,
            remedy=f"give one row for each of {', '.join(leg.joint_names)} and one column a rig",
        )
    lower, upper, fastest, _ = (limit[:, None] for limit in leg.limits)
    for quantity, per, values, low, high in (
        ("a position", "", q, lower, upper),
        ("a speed", "/s", v, -fastest, fastest),
    ):
        for k, joint, rig in _beyond(values, low, high)[:1]:
            show, taken = position_units(leg)[joint].show, values[:, joint]
            raise BadArgumentError(
                f"the motion asks {leg.joint_names[joint]} for {quantity} of {show(values[k, joint, rig])}{per} "
                f"at {time[k]:.2f} s",
                where=leg.description.name,
                remedy=f"it goes from {show(taken.min())}{per} to {show(taken.max())}{per}, the joint from "
                f"{show(low[joint, 0])}{per} to {show(high[joint, 0])}{per}: make the motion smaller or slower",
            )


def _beyond(values: FloatArray, lowest: FloatArray, highest: FloatArray) -> NDArray[np.intp]:
    """Places of values beyond limits; NaN counts as beyond."""
    return np.argwhere(~((values >= lowest - ROUNDED) & (values <= highest + ROUNDED)))
