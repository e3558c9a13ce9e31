"""A scene: drawing commands, layers that can be hidden, and the camera."""

from __future__ import annotations

import html
import os
from dataclasses import dataclass
from typing import Any, NamedTuple

from exoid.tools.files import write_whole

from .commands import Command, Layer
from .page import write_page
from .readings import Readings
from .server import SceneServer


class Camera(NamedTuple):
    """Camera position, given by the volume to be seen; the page fits it to windows of any shape."""

    centre: tuple[float, float, float]  # centre of the volume [m]
    direction: tuple[float, float, float]  # direction from the centre to the camera
    half_width: float  # half the size of the volume across the picture [m]
    half_height: float  # half its size upwards [m]
    half_depth: float  # half its size towards the camera [m]


@dataclass(frozen=True, eq=False, repr=False)
class Scene:
    """Legs in three dimensions, drawn in a browser; made by :func:`exoid.view.scene`.

    As the last expression of a notebook's cell it is displayed. Its page needs no network and no server.

    Attributes:
        title: Title of the page.
        commands: Drawing commands of meshcat's viewer.
        layers: Objects that can be hidden.
        camera: Camera position.
        duration: Duration of the replay [s]; 0 for legs that stand still.
        notes: One sentence for each visual that could not be drawn.
        readings: Angle and torque of each joint at each frame, centre of pressure and force of each foot.
    """

    title: str
    commands: tuple[Command, ...]
    layers: tuple[Layer, ...]
    camera: Camera
    duration: float = 0.0
    notes: tuple[str, ...] = ()
    readings: tuple[Readings, ...] = ()

    def html(self) -> str:
        """Render the scene as a self-contained HTML page.

        Returns:
            Text of a page that opens without a network.
        """
        return write_page(self.to_json())

    def iframe(self) -> str:
        """Render the scene as an HTML element for another page; several of them do not interfere.

        Returns:
            An ``<iframe>`` element.
        """
        source, style = html.escape(self.html(), quote=True), "width: 100%; height: 480px; border: 0"
        return f'<iframe title="{html.escape(self.title, quote=True)}" style="{style}" srcdoc="{source}"></iframe>'

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write :meth:`html` to a file, whole or not at all.

        Args:
            path: Path of the file.

        Raises:
            ExoidError: The file cannot be written.
        """
        write_whole(path, [self.html()])

    def serve(self, port: int | None = None) -> SceneServer:
        """Serve the scene to browsers of this machine only, until the server is closed.

        Args:
            port: Port to listen on, 0 for any free port; None for 7000, or any free port if that is taken.

        Returns:
            The server, a context manager.

        Raises:
            ExoidError: The port is taken, or not a port number; or the viewer is not installed.

        Example:
            >>> with exoid.view.scene(exoid.load_leg("bleex")).serve() as server:  # doctest: +SKIP
            ...     server.wait()
        """
        return SceneServer(self.html(), port)

    def to_json(self) -> dict[str, Any]:
        """Describe the scene as data for its page.

        Returns:
            Title, commands, layers, camera, duration, notes and readings of the joints.
        """
        return {
            "title": self.title,
            "commands": self.commands,
            "layers": [layer._asdict() for layer in self.layers],
            "camera": self.camera._asdict(),
            "duration": self.duration,
            "notes": self.notes,
            "joints": [each.to_json() for each in self.readings],
        }

    def _repr_html_(self) -> str:
        return self.iframe()

    def __repr__(self) -> str:
        """Title, duration and layers."""
        replay = f", {self.duration:.4g} s" if self.duration else ""
        return f"Scene({self.title!r}{replay}; {', '.join(layer.label for layer in self.layers)})"
