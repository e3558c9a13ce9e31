"""The leg in three dimensions, drawn by meshcat's viewer in a browser."""

from .build_scene import scene
from .scene import Scene

__all__ = ["Scene", "scene"]
