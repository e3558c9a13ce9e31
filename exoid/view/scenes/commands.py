"""Drawing commands of meshcat's viewer, as data, and drawings: commands with their legend, keyframes and notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .transforms import homogeneous, quaternions
from .visual import Visual, to_threejs

Command = dict[str, Any]
"""One command: "type", "path", and the arguments of that type."""

FRAMES_PER_SECOND = 30.0

ROOT = "/exoid"
"""Path above everything that exoid draws."""


class Layer(NamedTuple):
    """Objects that the legend shows and hides together."""

    label: str  # name in the legend
    colours: tuple[str, ...]  # colours in the legend, one or several
    paths: tuple[str, ...]  # paths of the objects
    scale: str = ""  # what the length or radius of an arrow means; "" for objects that are no arrows


@dataclass(frozen=True, eq=False)
class Drawing:
    """Commands that draw something, its entries in the legend, and its motion."""

    commands: Sequence[Command] = ()
    layers: Sequence[Layer] = ()
    tracks: Mapping[str, Mapping[str, FloatArray]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  # one sentence for each thing that could not be drawn

    def __add__(self, other: Drawing) -> Drawing:
        """Draw both."""
        return Drawing(
            [*self.commands, *other.commands],
            [*self.layers, *other.layers],
            {**self.tracks, **other.tracks},
            self.notes + other.notes,
        )


def moving(
    path: str, position: FloatArray, rotation: FloatArray | None = None, scale: FloatArray | None = None
) -> Drawing:
    """Move an object: place and scale it as in the first frame, (F, 3) each, with keyframes of what changes."""
    turn = np.eye(3) if rotation is None else rotation
    matrix = homogeneous(position[0], turn if turn.ndim == 2 else turn[0])
    if scale is not None:
        matrix[:3, :3] *= scale[0]
    tracks = {} if len(position) == 1 else {"position": position}
    if turn.ndim == 3 and len(turn) > 1:
        tracks["quaternion"] = quaternions(turn)
    if scale is not None and len(scale) > 1:
        tracks["scale"] = scale
    return Drawing([set_transform(path, matrix)], tracks={path: tracks} if tracks else {})


def child_path(path: str, name: str) -> str:
    """Path of a child. Slashes in its name are replaced, as they separate the names of a path."""
    return f"{path}/{name.replace('/', '|')}"


def set_object(path: str, visuals: Sequence[Visual], *, shadows: bool = True) -> Command:
    """Command that draws visuals at a path."""
    return {"type": "set_object", "path": path, "object": to_threejs(visuals, shadows=shadows)}


def set_transform(path: str, transform: FloatArray) -> Command:
    """Command that sets the transform from the frame of a path to that of its parent, (4, 4)."""
    return {"type": "set_transform", "path": path, "matrix": _rounded(transform.T.ravel())}


def set_property(path: str, name: str, value: object) -> Command:
    """Command that sets a property of the object at a path."""
    return {"type": "set_property", "path": path, "property": name, "value": value}


def set_animation(tracks: Mapping[str, Mapping[str, FloatArray]]) -> Command:
    """Command that animates the objects at paths, at :data:`FRAMES_PER_SECOND`, in a loop."""
    animations = []
    for path, quantities in tracks.items():
        moves = []  # keyframes of each quantity in three.js's format
        for name, values in quantities.items():
            keys = [{"time": frame, "value": _rounded(value)} for frame, value in enumerate(values)]
            kind = "quaternion" if name == "quaternion" else "vector3"
            moves.append({"name": f".{name}", "type": kind, "keys": keys})
        clip = {"fps": FRAMES_PER_SECOND, "name": "replay", "tracks": moves}
        animations.append({"path": path, "clip": clip})
    return {"type": "set_animation", "animations": animations, "options": {"play": True, "repetitions": 1_000_000}}


def _rounded(values: FloatArray) -> list[float]:
    return [float(v) for v in np.round(values, 5)]
