"""Limits of a planned motion, and clearance of the foot from the ground and from the other segments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.joint_numbers import for_joints
from exoid.leg.leg import Leg
from exoid.leg.torso import TorsoMotion
from exoid.tools.numbers import checked

MARGIN = np.deg2rad(3.0)
"""Margin to the joint limits of the URDF for overshoot of the servos [rad]."""


STEP = 1e-6
"""Step of the central difference of a distance [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class Clearance:
    """Points of the last segment that keep a distance from the ground and from the other segments."""

    # points such as heel and toe: forward and upward distance from the last joint at the zero pose [m], (k, 2)
    points: FloatArray
    ground: float = -np.inf  # height of the ground above the first joint [m], negative; −inf for none
    distance: float = 0.05  # smallest distance to the ground and to the lines between other joints [m]

    def __post_init__(self) -> None:
        """Check the numbers."""
        if np.ndim(self.points) != 2 or np.shape(self.points)[1] != 2 or not np.isfinite(self.points).all():
            raise BadArgumentError(
                f"points of shape {np.shape(self.points)}", remedy="give (forward, up) of each in metres"
            )
        if not (self.ground < 0.0 and 0.0 <= self.distance < np.inf):
            raise BadArgumentError(
                f"ground at {self.ground:g} m, distance {self.distance:g} m",
                remedy="the ground is below the first joint (negative), the distance not negative",
            )

    def __repr__(self) -> str:
        """Count the points; name ground and distance."""
        return f"Clearance({len(self.points)} points, ground {self.ground:g} m, distance {self.distance:g} m)"

    def margin(self, leg: Leg, q: FloatArray, pitch: float = 0.0) -> FloatArray:
        """Compute each distance less the smallest distance allowed."""
        joints, points = _positions(leg, q, pitch, self.points)
        parts = []
        if np.isfinite(self.ground):
            parts.append(points[..., 1] - self.ground)
        for k in range(joints.shape[1] - 2):
            parts.append(_distance(points, joints[:, k, None], joints[:, k + 1, None]))
        return np.hstack(parts) - self.distance if parts else np.empty((len(q), 0))

    def margin_derivative(self, leg: Leg, q: FloatArray, pitch: float = 0.0) -> FloatArray:
        """Compute the derivative of the margins by each angle, with central differences."""
        steps = STEP * np.eye(q.shape[1])
        moved = np.concatenate([q + sign * step for sign in (1.0, -1.0) for step in steps])
        forward, backward = self.margin(leg, moved, pitch).reshape(2, q.shape[1], len(q), -1)
        return (forward - backward) / (2.0 * STEP)


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
            raise BadArgumentError(
                f"no range between the limits of joint {joint}: {np.rad2deg(self.lower[joint]):.1f}° to "
                f"{np.rad2deg(self.upper[joint]):.1f}°",
                remedy="give a lower limit below the upper one, both finite, or a smaller margin",
            )
        for name in ("velocity", "acceleration", "torque"):
            checked(getattr(self, name), f"a {name} limit", above=0.0, infinite=True)

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
        own, n, given = leg.limits, len(leg.joint_names), angles_deg or {}
        for k, names in enumerate(zip(leg.joint_names, leg.joint_labels, strict=True)):
            if leg.model.joints[k + 1].nq == 1 and not np.isfinite(own.lower[k]) and given.keys().isdisjoint(names):
                raise BadArgumentError(
                    f"the URDF has no limits of joint {names[0]!r}, which is not continuous",
                    remedy=f"give the range that is safe, in degrees: angles_deg={{{names[0]!r}: (low, high)}}",
                    command=f"give the range that is safe, in degrees: --angles {names[0]}=LOW:HIGH",
                    joints=(names[0],),
                )
        lower = np.where(np.isfinite(own.lower), own.lower, -np.pi) + margin
        upper = np.where(np.isfinite(own.upper), own.upper, np.pi) - margin
        for name, (low, high) in given.items():
            if name not in (*leg.joint_names, *leg.joint_labels):
                known = ", ".join(leg.joint_names)
                raise BadArgumentError(f"no joint {name!r} in the leg", remedy=f"its joints are {known}")
            joint = (*leg.joint_names, *leg.joint_labels).index(name) % n
            lower[joint] = max(lower[joint], np.deg2rad(low))
            upper[joint] = min(upper[joint], np.deg2rad(high))
        speed, change, effort = (
            for_joints(np.inf if x is None else x, n, f"{name} limits")
            for name, x in (("velocity", velocity), ("acceleration", acceleration), ("torque", torque))
        )
        return cls(lower, upper, np.minimum(own.velocity, speed), change, np.minimum(own.effort, effort), clearance)

    @property
    def span(self) -> FloatArray:
        """Range of angle [rad], (n,)."""
        return self.upper - self.lower


def _positions(leg: Leg, q: FloatArray, pitch: float, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Joints, (N, n, 2), and points of the last segment, (N, k, 2), forward and upward of the first joint [m]."""
    if leg.chain is not None:
        turn = np.exp(1j * (np.cumsum(leg.chain.signs * q, axis=1) + pitch))
        steps = turn[:, :-1] * (leg.chain.offsets @ [1.0, 1j])
        joints = np.hstack([np.zeros((len(q), 1)), np.cumsum(steps, axis=1)])
        foot = joints[:, -1:] + turn[:, -1:] * (points @ np.array([1.0, 1j]))
        return _plane(joints), _plane(foot)
    if list(leg.model.parents)[1:] != list(range(leg.model.njoints - 1)):
        raise NotSupportedError(
            "the clearance of a foot is that of one chain of joints, and the leg has several",
            where=leg.description.name,
            remedy="choose the joints of one leg (joints=...)",
        )
    placed = leg.forward_kinematics(q, TorsoMotion(pitch=pitch) if pitch else None)
    zero = leg.forward_kinematics(np.zeros((1, q.shape[1]))).rotation[0, -1]
    space = np.column_stack([points[:, 0], np.zeros(len(points)), points[:, 1]]) @ zero  # in the last joint's frame
    foot = placed.translation[:, -1:] + np.einsum("tij,kj->tki", placed.rotation[:, -1], space)
    origin = placed.translation[:, :1]
    return (placed.translation - origin)[..., [0, 2]], (foot - origin)[..., [0, 2]]


def _plane(x: FloatArray) -> FloatArray:
    return np.stack([x.real, x.imag], axis=-1)


def _distance(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Distances of points from the line between two joints [m], (N, k)."""
    along, way = end - start, points - start
    length = np.maximum((along**2).sum(axis=-1), 1e-12)
    share = np.clip((along * way).sum(axis=-1) / length, 0.0, 1.0)
    return np.asarray(np.linalg.norm(way - share[..., None] * along, axis=-1))
