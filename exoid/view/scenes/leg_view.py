"""What one leg does in a scene: drawn, posed or moving, with its forces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.view.colours import IDENTIFIED

from .arrows import WEIGHT
from .commands import Command, Tracks, child, place
from .forces import Poses, force_places, force_tracks, torques, weights
from .leg_geometry import Figure
from .parts import Look
from .replay import Replay
from .scene import Layer, Standing
from .visuals import PLAIN

GHOST = Look(IDENTIFIED, 0.35, behind=True)
"""Of the second leg."""


class LegView(NamedTuple):
    """A leg in a scene.

    Attributes:
        commands: That draw it.
        layers: That can be switched on and off.
        tracks: How it moves.
        extent: Points whose hull contains it [m], (k, 3).
        standing: The leg, to be posed later.
    """

    commands: list[Command]
    layers: list[Layer]
    tracks: Tracks
    extent: FloatArray
    standing: Standing


class _Group(NamedTuple):
    """What one layer shows: paths, and the command that draws something there."""

    label: str
    colours: tuple[str, ...]
    drawn: Iterable[tuple[str, Command]]


def act(figure: Figure, q: FloatArray, replay: Replay | None, ghost_label: str) -> LegView:
    """Draw a leg in a pose, or replaying a recording.

    Args:
        figure: The leg.
        q: Pose [rad], (n,), where nothing is replayed.
        replay: What is.
        ghost_label: What the legend calls the second leg.
    """
    poses = Poses.of(figure, q, replay)
    upright = figure.skeleton.upright(poses.pitch)
    standing = Standing(figure.skeleton, figure.root, figure.mounts(figure.root))
    commands = [place(figure.root, upright), *figure.frames(figure.root), *standing.pose(poses.q[0])]
    layers, tracks, extent = [], {}, figure.extent(poses.q)
    for label, colours, drawn in _groups(figure, poses):
        paths, drawing = zip(*drawn, strict=True)
        commands += drawing
        layers.append(Layer(label, colours, paths))
    commands += force_places(figure, poses)
    if len(poses.q) > 1:
        tracks = _moving(figure, figure.root, poses.q) | force_tracks(figure, poses)
    ghost = None if replay is None else replay.ghost_angles(figure.leg)
    if ghost is not None:
        root = child(figure.root, "ghost")
        commands += [*figure.frames(root), *(command for _, command in figure.without_torso().draw(root, GHOST))]
        layers.insert(1, Layer(ghost_label, (GHOST.colour,), (root,)))
        tracks |= _moving(figure, root, ghost)
        extent = np.vstack([extent, figure.extent(ghost)])
    return LegView(commands, layers, tracks, extent @ upright[:3, :3].T + upright[:3, 3], standing)


def _groups(figure: Figure, poses: Poses) -> Iterator[_Group]:
    colours = tuple(dict.fromkeys(figure.colours))
    masses = [each for inertias in figure.inertias for each in figure.draw_inertias(inertias, "mass")]
    yield _Group("leg", (PLAIN,), figure.draw(figure.root))
    yield _Group("joint axes", colours, figure.draw_axes())
    yield _Group("centres of mass", tuple(inertias.colour for inertias in figure.inertias), masses)
    for inertias in figure.inertias:
        yield _Group(f"{inertias.label} inertia", (inertias.colour,), figure.draw_inertias(inertias, "inertia"))
    yield _Group("weights", (WEIGHT,), weights(figure))
    yield _Group("measured torque" if poses.measured else "torque against gravity", colours, torques(figure))


def _moving(figure: Figure, root: str, q: FloatArray) -> Tracks:
    motion = figure.skeleton.motion(q)
    tracks: Tracks = {}
    for joint, (path, turns) in enumerate(zip(figure.mounts(root), figure.skeleton.turning, strict=True)):
        name, values = ("quaternion", motion.quaternion) if turns else ("position", motion.position)
        tracks[f"{path}/body"] = {name: values[:, joint]}
    return tracks
