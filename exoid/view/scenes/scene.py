"""A scene: drawing commands, what can be switched on and off, and where to look from."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.files import write_whole

from .commands import Command, place
from .page import write_page
from .server import SceneServer
from .skeleton import Skeleton, joint_angles


class Layer(NamedTuple):
    """Something that can be switched on and off.

    Attributes:
        label: What the legend calls it.
        colours: Of its swatch, one or several.
        paths: Where it is drawn.
        shown: Whether it is at first.
    """

    label: str
    colours: tuple[str, ...]
    paths: tuple[str, ...]
    shown: bool = True


class Camera(NamedTuple):
    """Where to look from so that everything is in the picture, however wide the window.

    Attributes:
        centre: Looked at [m].
        towards: Direction from there to the camera.
        half_width: Of what is to be seen, across the picture [m].
        half_height: And upwards [m].
        half_depth: And towards the camera [m].
    """

    centre: tuple[float, float, float]
    towards: tuple[float, float, float]
    half_width: float
    half_height: float
    half_depth: float


@dataclass(frozen=True, eq=False)
class Standing:
    """A leg in a scene.

    Attributes:
        skeleton: Its bodies.
        root: Path of its torso.
        mounts: Path of the frame of each joint, in which its body moves.
    """

    skeleton: Skeleton
    root: str
    mounts: tuple[str, ...]

    def pose(self, q: FloatArray) -> list[Command]:
        """Commands that put the joints to these angles [rad], (n,)."""
        within = self.skeleton.within(q)[0]
        return [place(f"{mount}/body", each) for mount, each in zip(self.mounts, within, strict=True)]


@dataclass(frozen=True, eq=False, repr=False)
class Scene:
    """A leg in three dimensions, to be looked at in a browser; made by :func:`exoid.view.scene`.

    The last expression of a notebook's cell, it shows itself there. The page needs no network and no server.

    Attributes:
        title: Of the page.
        commands: What meshcat's viewer draws.
        layers: What can be switched on and off.
        camera: Where to look from.
        duration: Of the replay [s]; 0 for a leg that stands still.
        legs: The legs in it.
        notes: What could not be drawn as asked.
    """

    title: str
    commands: tuple[Command, ...]
    layers: tuple[Layer, ...]
    camera: Camera
    duration: float = 0.0
    legs: tuple[Standing, ...] = ()
    notes: tuple[str, ...] = field(default=())

    def html(self) -> str:
        """Write the scene as one self-contained HTML page, which opens without a network."""
        return write_page(self.to_json())

    def iframe(self, height: int = 480) -> str:
        """Write the scene as an HTML element to put into another page; several of them do not disturb each other.

        Args:
            height: [pixels].
        """
        source = html.escape(self.html(), quote=True)
        style = f"width: 100%; height: {height:d}px; border: 0"
        return f'<iframe title="{html.escape(self.title, quote=True)}" style="{style}" srcdoc="{source}"></iframe>'

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write :meth:`html` to a file, whole or not at all.

        Raises:
            ExoidError: The file cannot be written.
        """
        write_whole(path, [self.html()])

    def serve(self, port: int | None = None) -> SceneServer:
        """Serve the scene to browsers of this machine, and to no one else, until the server is closed.

        Args:
            port: To listen on; None for meshcat's 7000, or any that is free where that is taken.

        Returns:
            The server, a context manager.

        Raises:
            ExoidError: The port is taken.

        Example:
            >>> with exoid.view.scene(exoid.load_leg("bleex")).serve() as server:  # doctest: +SKIP
            ...     server.pose({"left_knee": -0.5})
        """
        return SceneServer(self, port)

    def pose(self, angles: Mapping[str, float]) -> list[Command]:
        """Commands that put joints to angles [rad] and all others of their legs to zero.

        Raises:
            ExoidError: There is no such joint.
        """
        names = [name for leg in self.legs for name in leg.skeleton.leg.joint_names]
        unknown = sorted(set(angles) - set(names))
        if unknown:
            raise ExoidError(f"no joint {', '.join(unknown)}", remedy=f"the scene has {', '.join(names)}")
        return [
            command for leg in self.legs for command in leg.pose(joint_angles(leg.skeleton.leg.joint_names, angles))
        ]

    def to_json(self) -> dict[str, Any]:
        """Everything that the page needs."""
        return {
            "title": self.title,
            "commands": self.commands,
            "layers": [layer._asdict() for layer in self.layers],
            "camera": self.camera._asdict(),
            "duration": self.duration,
            "notes": self.notes,
        }

    def _repr_html_(self) -> str:
        return self.iframe()

    def __repr__(self) -> str:
        """Name what is in it."""
        replay = f", {self.duration:.4g} s" if self.duration else ""
        return f"Scene({self.title!r}{replay}; {', '.join(layer.label for layer in self.layers)})"
