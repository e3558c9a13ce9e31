"""The drawing commands of meshcat's viewer, as data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from exoid._typing import FloatArray

from .parts import Part, to_three

Command = dict[str, Any]
"""One command: "type", "path", and what belongs to it."""

Tracks = dict[str, dict[str, FloatArray]]
"""What moves at which path: "quaternion" (F, 4), "position" (F, 3) or "scale" (F, 3)."""

FRAMES_PER_SECOND = 30.0


def child(path: str, name: str) -> str:
    """Path of a child; a slash in its name would make two of it."""
    return f"{path}/{name.replace('/', '|')}"


def show(path: str, parts: Sequence[Part], *, shadows: bool = True) -> Command:
    """Draw parts at a path."""
    return {"type": "set_object", "path": path, "object": to_three(parts, shadows=shadows)}


def place(path: str, transform: FloatArray) -> Command:
    """Put what is at a path to a place in its parent's frame, (4, 4)."""
    return {"type": "set_transform", "path": path, "matrix": _rounded(transform.T.ravel())}


def set_property(path: str, name: str, value: object) -> Command:
    """Set a property of what is at a path."""
    return {"type": "set_property", "path": path, "property": name, "value": value}


def animate(tracks: Tracks) -> Command:
    """Move what is at paths, at :data:`FRAMES_PER_SECOND`, over and over."""
    animations = [
        {
            "path": path,
            "clip": {
                "fps": FRAMES_PER_SECOND,
                "name": "replay",
                "tracks": [_track(name, values) for name, values in of_path.items()],
            },
        }
        for path, of_path in tracks.items()
    ]
    return {"type": "set_animation", "animations": animations, "options": {"play": True, "repetitions": 1_000_000}}


def _track(name: str, values: FloatArray) -> dict[str, Any]:
    kind = "quaternion" if name == "quaternion" else "vector3"
    keys = [{"time": frame, "value": _rounded(value)} for frame, value in enumerate(values)]
    return {"name": f".{name}", "type": kind, "keys": keys}


def _rounded(values: FloatArray) -> list[float]:
    return [float(v) for v in np.round(values, 5)]
