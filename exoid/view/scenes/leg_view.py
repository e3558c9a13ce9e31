"""Drawing of one leg in a scene: posed or moving, with its forces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.view.colours import PREDICTED, WEIGHT

from .commands import Command, Tracks, child_path, set_transform
from .forces import (
    animate_arrows,
    draw_torques,
    draw_weights,
    place_arrows,
    torque_key,
    weight_paths,
    weight_scale,
)
from .ground_arrows import GroundArrows, quaternions
from .leg_geometry import LegGeometry
from .leg_trajectory import LegTrajectory
from .replay import Replay
from .scene import Layer, PosableLeg
from .standing import Standing
from .transforms import align_z, homogeneous
from .urdf_visuals import PLAIN
from .visual import Material

GHOST = Material(PREDICTED, 0.35, behind=True)
"""Material of the second leg."""


FEW = 60
"""Frames of a moving base that the camera is set by."""


class LegView(NamedTuple):
    """Drawing of one leg in a scene."""

    commands: list[Command]  # commands that draw it
    layers: list[Layer]  # groups of objects that can be hidden
    tracks: Tracks  # keyframes of its motion; empty for a leg that stands still
    bounding_points: FloatArray  # points whose convex hull contains it [m], (k, 3)
    posable: PosableLeg  # the leg, for poses that are set later
    floor: float | None = None  # height of the ground [m] where the base moves, else None
    notes: tuple[str, ...] = ()  # one sentence for each kind of force that could not be drawn
    # points whose convex hull contains the leg and its ellipsoids [m], (k, 3)
    visible_points: FloatArray = np.empty((0, 3))

    @classmethod
    def of(cls, geometry: LegGeometry, q: FloatArray, replay: Replay | None, ghost_label: str) -> LegView:
        """Draw a leg in a pose, or replaying a recording."""
        trajectory = LegTrajectory.of(geometry.leg, q, replay)
        torso = geometry.skeleton.torso_placement(trajectory.pitch)
        posable = PosableLeg(geometry.skeleton, geometry.root, geometry.joint_paths(geometry.root))
        commands = [
            set_transform(geometry.root, torso),
            *geometry.place_joints(geometry.root),
            *posable.pose(trajectory.q[0]),
        ]
        layers = []
        for label, colours, drawing, scale in _layers(geometry, trajectory):
            drawn = list(drawing)
            commands += drawn
            layers.append(Layer(label, colours, tuple(command["path"] for command in drawn), scale=scale))
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
        points, ellipsoids = (
            each @ torso[:3, :3].T + torso[:3, 3] for each in (points, geometry.ellipsoid_points(trajectory.q))
        )
        visible = np.vstack([points, ellipsoids])
        return cls(commands, layers, tracks, points, posable, visible_points=visible)

    def standing(self, source: Leg | Estimate, geometry: LegGeometry, replay: Replay | None) -> LegView:
        """Let the base move, where a recording tells how, with arrows of the forces of the ground."""
        base = None if replay is None else Standing.of(geometry, replay)
        if replay is None or base is None:
            return self
        arrows = GroundArrows.of(source, geometry.leg, replay, base)
        down = np.swapaxes(base.rotation, 1, 2) @ align_z((0.0, 0.0, -1.0))
        tracks = {path: dict(track) for path, track in self.tracks.items()}
        tracks[geometry.root] = {"position": base.position, "quaternion": quaternions(base.rotation)}
        commands = [*self.commands, set_transform(geometry.root, homogeneous(base.position[0], base.rotation[0]))]
        for path in weight_paths(geometry):
            if path in tracks:
                tracks[path]["quaternion"] = quaternions(down)
                commands.append(set_transform(path, homogeneous(tracks[path]["position"][0], down[0])))
        few = np.linspace(0, len(base.position) - 1, min(FEW, len(base.position))).astype(np.intp)
        points, visible = (
            np.vstack([_corners(each) @ base.rotation[f].T + base.position[f] for f in few] + [arrows.points])
            for each in (self.bounding_points, self.visible_points)
        )
        return LegView(
            commands + arrows.commands,
            self.layers + arrows.layers,
            tracks | arrows.tracks,
            points,
            self.posable,
            base.floor,
            arrows.notes,
            visible,
        )


def _corners(points: FloatArray) -> FloatArray:
    """Corners of the box around points, (8, 3)."""
    return np.array(np.meshgrid(*zip(points.min(axis=0), points.max(axis=0), strict=True))).reshape(3, -1).T


class _LayerDrawing(NamedTuple):
    """Label and colours of a layer, the commands that draw it, and the scale of its arrows."""

    label: str
    colours: tuple[str, ...]
    commands: Iterable[Command]
    scale: str = ""


def _layers(geometry: LegGeometry, trajectory: LegTrajectory) -> Iterator[_LayerDrawing]:
    """Layers of the legend, from top to bottom."""
    colours = tuple(dict.fromkeys(geometry.joint_colours))
    yield _LayerDrawing("leg", (PLAIN,), geometry.draw_bodies(geometry.root))
    yield _LayerDrawing("joint axes", colours, geometry.draw_axes())
    sources = tuple(inertias.colour for inertias in geometry.inertias)
    yield _LayerDrawing("centres of mass", sources, geometry.draw_masses())
    for inertias in geometry.inertias:
        yield _LayerDrawing(f"{inertias.label} inertia", (inertias.colour,), geometry.draw_inertias(inertias))
    yield _LayerDrawing("weights", (WEIGHT,), draw_weights(geometry), weight_scale(geometry))
    torque = "measured torque" if trajectory.measured else "torque against gravity"
    yield _LayerDrawing(torque, colours, draw_torques(geometry), torque_key(geometry, trajectory))


def _joint_tracks(geometry: LegGeometry, root: str, q: FloatArray) -> Tracks:
    """Keyframes of the joints' motion at angles (F, n) [rad]."""
    keyframes = geometry.skeleton.joint_keyframes(q)
    tracks: Tracks = {}
    for joint, (path, revolute) in enumerate(zip(geometry.joint_paths(root), geometry.skeleton.revolute, strict=True)):
        name, values = ("quaternion", keyframes.quaternion) if revolute else ("position", keyframes.position)
        tracks[f"{path}/body"] = {name: values[:, joint]}
    return tracks
