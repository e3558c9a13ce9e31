"""Arrows of the weights and joint torques of a leg: their drawing, placement and animation."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import FloatArray
from exoid.view.colours import WEIGHT

from .arrows import circular_arrow, straight_arrow, torque_scale
from .commands import Command, Tracks, child_path, set_object, set_transform
from .leg_geometry import LegGeometry
from .leg_trajectory import LegTrajectory
from .transforms import align_z, homogeneous

WEIGHT_LENGTH = 0.3
"""Length of the arrow of the heaviest body over the reach of the leg."""

TORQUE_RADIUS = 0.17
"""Radius of the arrow of the largest torque over the reach of the leg."""

THICKNESS = 0.011
"""Thickness of arrows over the reach of the leg."""


def draw_weights(geometry: LegGeometry) -> Iterator[Command]:
    """Commands that draw an arrow for the weight of each body, its length proportional to the weight."""
    reach, inertias = geometry.skeleton.reach, geometry.inertias[-1].bodies
    heaviest = max(inertia.mass for inertia in inertias)
    for path, inertia in zip(weight_paths(geometry), inertias, strict=True):
        length = WEIGHT_LENGTH * reach * inertia.mass / heaviest
        yield set_object(path, straight_arrow(length, THICKNESS * reach, WEIGHT), shadows=False)


def draw_torques(geometry: LegGeometry) -> Iterator[Command]:
    """Commands that draw an arrow for the torque of each joint, at the size of the largest torque."""
    reach = geometry.skeleton.reach
    for path, colour in zip(_torque_paths(geometry), geometry.joint_colours, strict=True):
        yield set_object(path, circular_arrow(TORQUE_RADIUS * reach, THICKNESS * reach, colour), shadows=False)


def weight_scale(geometry: LegGeometry) -> str:
    """Say what the length of the arrow of a weight means."""
    heaviest = max(inertia.mass for inertia in geometry.inertias[-1].bodies)
    weight = heaviest * float(np.linalg.norm(geometry.leg.model.gravity.linear))
    return f"arrow of {WEIGHT_LENGTH * geometry.skeleton.reach:.2g} m = {weight:.3g} N"


def torque_key(geometry: LegGeometry, trajectory: LegTrajectory) -> str:
    """Say what the radius of the arrow of a torque means; its area is proportional to the torque."""
    largest = float(np.abs(trajectory.tau).max())
    if largest == 0.0:
        return ""
    unit = "N·m" if all(geometry.skeleton.revolute) else "N·m or N"
    return f"radius of {TORQUE_RADIUS * geometry.skeleton.reach:.2g} m = {largest:.3g} {unit}"


def place_arrows(geometry: LegGeometry, trajectory: LegTrajectory) -> Iterator[Command]:
    """Commands that place and scale the arrows as in the first frame."""
    down = align_z(geometry.leg.gravity_of_tilted_torso(trajectory.pitch))
    for path, centre in zip(weight_paths(geometry), _centres(geometry, trajectory.q[:1]), strict=True):
        yield set_transform(path, homogeneous(centre[0], down))
    for path, axis in zip(geometry.joint_paths(geometry.root), geometry.skeleton.axes, strict=True):
        yield set_transform(f"{path}/torque", homogeneous(np.zeros(3), align_z(axis)))
    for path, scale in _scales(geometry, trajectory).items():
        yield set_transform(path, np.diag([*scale[0], 1.0]))


def animate_arrows(geometry: LegGeometry, trajectory: LegTrajectory) -> Tracks:
    """Keyframes of the positions of weights and of the scales of torques."""
    centres = zip(weight_paths(geometry), _centres(geometry, trajectory.q), strict=True)
    tracks: Tracks = {path: {"position": centre} for path, centre in centres}
    return tracks | {path: {"scale": scale} for path, scale in _scales(geometry, trajectory).items()}


def weight_paths(geometry: LegGeometry) -> list[str]:
    """Paths of the arrows of the bodies' weights."""
    return [child_path(geometry.root, f"weight {name}") for name in geometry.leg.link_names]


def _torque_paths(geometry: LegGeometry) -> list[str]:
    return [f"{path}/torque/arrow" for path in geometry.joint_paths(geometry.root)]


def _centres(geometry: LegGeometry, q: FloatArray) -> FloatArray:
    """Centres of mass of the moving bodies in the torso's frame [m], (n, F, 3)."""
    placements = geometry.skeleton.body_placements(q)[:, 1:]
    levers = np.array([inertia.lever for inertia in geometry.inertias[-1].bodies])
    centres = np.einsum("fbij,bj->fbi", placements[..., :3, :3], levers) + placements[..., :3, 3]
    return np.asarray(centres.transpose(1, 0, 2))


def _scales(geometry: LegGeometry, trajectory: LegTrajectory) -> dict[str, FloatArray]:
    """Scale of each torque's arrow by path, (F, 3)."""
    largest = float(np.abs(trajectory.tau).max())
    pairs = zip(_torque_paths(geometry), trajectory.tau.T, strict=True)
    return {path: torque_scale(tau, largest) for path, tau in pairs}
