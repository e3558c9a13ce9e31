"""Drawing commands of meshcat's viewer, as data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from exoid._typing import FloatArray

from .visual import Visual, to_threejs

Command = dict[str, Any]
"""One command: "type", "path", and the arguments of that type."""

Tracks = dict[str, dict[str, FloatArray]]
"""Keyframes of each path: "quaternion" (F, 4), "position" (F, 3) or "scale" (F, 3)."""

FRAMES_PER_SECOND = 30.0

ROOT = "/exoid"
"""Path above everything that exoid draws."""


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


def set_animation(tracks: Tracks) -> Command:
    """Command that animates the objects at paths, at :data:`FRAMES_PER_SECOND`, in a loop."""
    animations = [
        {
            "path": path,
            "clip": {
                "fps": FRAMES_PER_SECOND,
                "name": "replay",
                "tracks": [_track(name, values) for name, values in quantities.items()],
            },
        }
        for path, quantities in tracks.items()
    ]
    return {"type": "set_animation", "animations": animations, "options": {"play": True, "repetitions": 1_000_000}}


def _track(name: str, values: FloatArray) -> dict[str, Any]:
    """Describe keyframes of one quantity in three.js's format."""
    kind = "quaternion" if name == "quaternion" else "vector3"
    keys = [{"time": frame, "value": _rounded(value)} for frame, value in enumerate(values)]
    return {"name": f".{name}", "type": kind, "keys": keys}


def _rounded(values: FloatArray) -> list[float]:
    return [float(v) for v in np.round(values, 5)]
