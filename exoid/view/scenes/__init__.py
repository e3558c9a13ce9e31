"""The leg in three dimensions, drawn by meshcat's viewer in a browser."""

from .scene import Scene
from .server import SceneServer
from .staging import scene

__all__ = ["Scene", "SceneServer", "scene"]
