"""Weights and joint torques of a leg: arrows, where they are, and how they change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torso import TorsoMotion

from .arrows import WEIGHT, around, straight, torque_scale
from .commands import Command, Tracks, child, place, show
from .leg_geometry import Figure
from .parts import moved, towards
from .replay import Replay

LONGEST = 0.3
"""Length of the arrow of the heaviest body, times the reach of the leg."""

WIDEST = 0.17
"""Radius of the arrow of the largest torque, times the reach of the leg."""

THICKNESS = 0.011
"""Of arrows, times the reach of the leg."""


class Poses(NamedTuple):
    """What a leg does, frame by frame.

    Attributes:
        q: Angles [rad], (F, n); one frame for a leg that stands still.
        tau: Torques of the actuators [N·m], (F, n).
        measured: Whether these were; else they hold the leg against gravity.
        pitch: Of the torso [rad].
    """

    q: FloatArray
    tau: FloatArray
    measured: bool
    pitch: float

    @classmethod
    def of(cls, figure: Figure, q: FloatArray, replay: Replay | None) -> Poses:
        """Take them from a recording, or stand in a pose, (n,)."""
        recorded = None if replay is None else replay.angles(figure.leg)
        torques = None if replay is None else replay.torques(figure.leg)
        angles = q[np.newaxis] if recorded is None else recorded
        pitch = 0.0 if replay is None else replay.pitch
        if torques is not None:
            return cls(angles, torques, True, pitch)
        return cls(angles, figure.leg.gravity(angles, TorsoMotion(pitch) if pitch else None), False, pitch)


def weights(figure: Figure) -> Iterator[tuple[str, Command]]:
    """Paths and commands that draw the weight of each body."""
    reach, inertias = figure.skeleton.reach, figure.inertias[-1].bodies
    heaviest = max(inertia.mass for inertia in inertias)
    for path, inertia in zip(_weight_paths(figure), inertias, strict=True):
        arrow = straight(LONGEST * reach * inertia.mass / heaviest, THICKNESS * reach, WEIGHT)
        yield path, show(path, arrow, shadows=False)


def torques(figure: Figure) -> Iterator[tuple[str, Command]]:
    """Paths and commands that draw the torque of each joint, as large as the largest."""
    reach = figure.skeleton.reach
    for path, colour in zip(figure.mounts(figure.root), figure.colours, strict=True):
        arrow = around(WIDEST * reach, THICKNESS * reach, colour)
        yield f"{path}/torque", show(f"{path}/torque/arrow", arrow, shadows=False)


def force_places(figure: Figure, poses: Poses) -> Iterator[Command]:
    """Commands that put the arrows to where they are in the first frame."""
    down = towards(figure.leg.gravity_of_tilted_torso(poses.pitch))
    for path, centre in zip(_weight_paths(figure), _centres(figure, poses.q[:1]), strict=True):
        yield place(path, moved(centre[0], down))
    for path, axis in zip(figure.mounts(figure.root), figure.skeleton.axes, strict=True):
        yield place(f"{path}/torque", moved(np.zeros(3), towards(axis)))
    for path, scale in _scales(figure, poses).items():
        yield place(path, np.diag([*scale[0], 1.0]))


def force_tracks(figure: Figure, poses: Poses) -> Tracks:
    """How the arrows move and grow."""
    centres = zip(_weight_paths(figure), _centres(figure, poses.q), strict=True)
    tracks: Tracks = {path: {"position": centre} for path, centre in centres}
    return tracks | {path: {"scale": scale} for path, scale in _scales(figure, poses).items()}


def _weight_paths(figure: Figure) -> list[str]:
    return [child(figure.root, f"weight {name}") for name in figure.leg.link_names]


def _centres(figure: Figure, q: FloatArray) -> FloatArray:
    """Centres of mass of the moving bodies in the torso's frame [m], (n, F, 3)."""
    places = figure.skeleton.bodies(q)[:, 1:]
    levers = np.array([inertia.lever for inertia in figure.inertias[-1].bodies])
    centres = np.einsum("fbij,bj->fbi", places[..., :3, :3], levers) + places[..., :3, 3]
    return np.asarray(centres.transpose(1, 0, 2))


def _scales(figure: Figure, poses: Poses) -> dict[str, FloatArray]:
    largest = float(np.abs(poses.tau).max())
    mounts = figure.mounts(figure.root)
    return {f"{path}/torque/arrow": torque_scale(tau, largest) for path, tau in zip(mounts, poses.tau.T, strict=True)}
