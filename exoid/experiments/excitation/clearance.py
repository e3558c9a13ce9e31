"""Clearance of the foot from the ground and from the other segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.leg.torso import TorsoMotion

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
            raise ExoidError(f"points of shape {np.shape(self.points)}", remedy="give (forward, up) of each in metres")
        if not (self.ground < 0.0 and 0.0 <= self.distance < np.inf):
            raise ExoidError(
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


def _positions(leg: Leg, q: FloatArray, pitch: float, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Joints, (N, n, 2), and points of the last segment, (N, k, 2), forward and upward of the first joint [m]."""
    if leg.chain is not None:
        turn = np.exp(1j * (np.cumsum(leg.chain.signs * q, axis=1) + pitch))
        steps = turn[:, :-1] * (leg.chain.offsets @ [1.0, 1j])
        joints = np.hstack([np.zeros((len(q), 1)), np.cumsum(steps, axis=1)])
        foot = joints[:, -1:] + turn[:, -1:] * (points @ np.array([1.0, 1j]))
        return _plane(joints), _plane(foot)
    if list(leg.model.parents)[1:] != list(range(leg.model.njoints - 1)):
        raise ExoidError(
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
