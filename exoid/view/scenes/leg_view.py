"""Drawing of one leg in a scene: posed or moving, with its forces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.view.colours import IDENTIFIED

from .arrows import WEIGHT_COLOUR
from .commands import Command, Tracks, child_path, set_transform
from .forces import animate_arrows, draw_torques, draw_weights, place_arrows
from .leg_geometry import LegGeometry
from .leg_trajectory import LegTrajectory
from .replay import Replay
from .scene import Layer, PosableLeg
from .urdf_visuals import PLAIN
from .visual import Material

GHOST = Material(IDENTIFIED, 0.35, behind=True)
"""Material of the second leg."""


class LegView(NamedTuple):
    """Drawing of one leg in a scene.

    Attributes:
        commands: Commands that draw it.
        layers: Groups of objects that can be hidden.
        tracks: Keyframes of its motion; empty for a leg that stands still.
        bounding_points: Points whose convex hull contains it [m], (k, 3).
        posable: The leg, for poses that are set later.
    """

    commands: list[Command]
    layers: list[Layer]
    tracks: Tracks
    bounding_points: FloatArray
    posable: PosableLeg

    @classmethod
    def of(cls, geometry: LegGeometry, q: FloatArray, replay: Replay | None, ghost_label: str) -> LegView:
        """Draw a leg in a pose, or replaying a recording.

        Args:
            geometry: The leg.
            q: Pose [rad], (n,), of a leg that is not replayed.
            replay: The replay, or None.
            ghost_label: Name of the second leg in the legend.

        Returns:
            The drawing.
        """
        trajectory = LegTrajectory.of(geometry.leg, q, replay)
        torso = geometry.skeleton.torso_placement(trajectory.pitch)
        posable = PosableLeg(geometry.skeleton, geometry.root, geometry.joint_paths(geometry.root))
        commands = [
            set_transform(geometry.root, torso),
            *geometry.place_joints(geometry.root),
            *posable.pose(trajectory.q[0]),
        ]
        layers = []
        for label, colours, drawing in _layers(geometry, trajectory):
            drawn = list(drawing)
            commands += drawn
            layers.append(Layer(label, colours, tuple(command["path"] for command in drawn)))
        commands += place_arrows(geometry, trajectory)
        points, tracks = geometry.bounding_points(trajectory.q), {}
        if len(trajectory.q) > 1:
            tracks = _joint_tracks(geometry, geometry.root, trajectory.q) | animate_arrows(geometry, trajectory)
        ghost = None if replay is None else replay.ghost_angles(geometry.leg)
        if ghost is not None:
            root = child_path(geometry.root, "ghost")
            commands += [*geometry.place_joints(root), *geometry.without_torso().draw_bodies(root, GHOST)]
            layers.insert(1, Layer(ghost_label, (GHOST.colour,), (root,)))
            tracks |= _joint_tracks(geometry, root, ghost)
            points = np.vstack([points, geometry.bounding_points(ghost)])
        return cls(commands, layers, tracks, points @ torso[:3, :3].T + torso[:3, 3], posable)


class _LayerDrawing(NamedTuple):
    """Label and colours of a layer, and the commands that draw it."""

    label: str
    colours: tuple[str, ...]
    commands: Iterable[Command]


def _layers(geometry: LegGeometry, trajectory: LegTrajectory) -> Iterator[_LayerDrawing]:
    """Layers of the legend, from top to bottom."""
    colours = tuple(dict.fromkeys(geometry.joint_colours))
    yield _LayerDrawing("leg", (PLAIN,), geometry.draw_bodies(geometry.root))
    yield _LayerDrawing("joint axes", colours, geometry.draw_axes())
    sources = tuple(inertias.colour for inertias in geometry.inertias)
    yield _LayerDrawing("centres of mass", sources, geometry.draw_masses())
    for inertias in geometry.inertias:
        yield _LayerDrawing(f"{inertias.label} inertia", (inertias.colour,), geometry.draw_inertias(inertias))
    yield _LayerDrawing("weights", (WEIGHT_COLOUR,), draw_weights(geometry))
    torque = "measured torque" if trajectory.measured else "torque against gravity"
    yield _LayerDrawing(torque, colours, draw_torques(geometry))


def _joint_tracks(geometry: LegGeometry, root: str, q: FloatArray) -> Tracks:
    """Keyframes of the joints' motion at angles (F, n) [rad]."""
    keyframes = geometry.skeleton.joint_keyframes(q)
    tracks: Tracks = {}
    for joint, (path, revolute) in enumerate(zip(geometry.joint_paths(root), geometry.skeleton.revolute, strict=True)):
        name, values = ("quaternion", keyframes.quaternion) if revolute else ("position", keyframes.position)
        tracks[f"{path}/body"] = {name: values[:, joint]}
    return tracks
