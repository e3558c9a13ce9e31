"""Robots of the package example-robot-data by name, imported when one is named."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from exoid.errors import UnreadableInputError
from exoid.tools.extras import install_extra


def is_robot(name: str) -> bool:
    """Tell whether a name is that of a robot with a URDF."""
    return name.isidentifier() and name in _robots()


def urdf_of_robot(name: str) -> Path:
    """Find the URDF of a robot."""
    from example_robot_data.robots_loader import getModelPath  # noqa: PLC0415 - an extra

    robot = _robots()[name]
    inside = f"{robot.path}/{robot.urdf_subpath}/{robot.urdf_filename}"
    try:
        return Path(getModelPath(inside)) / inside
    except OSError as error:
        raise UnreadableInputError(
            f"no URDF of {name!r} ({error})", remedy=f"install its data: {install_extra('robots')}"
        ) from None


def folder_of_robot(name: str) -> Path:
    """Find the folder with the meshes of a robot."""
    inside = Path(_robots()[name].urdf_subpath, _robots()[name].urdf_filename)
    return urdf_of_robot(name).parents[len(inside.parts) - 1]


def how_to_name_one() -> str:
    """Say what makes robots known by name."""
    known = find_spec("example_robot_data") is not None
    return "the name of one in example-robot-data" if known else f"a robot's name after {install_extra('robots')}"


def _robots() -> Mapping[str, Any]:
    """Loaders by name of those with a URDF; none where the package is not installed."""
    try:
        from example_robot_data.robots_loader import ROBOTS  # noqa: PLC0415 - an extra, and a tenth of a second
    except ImportError:
        return {}
    return {name: loader for name, loader in ROBOTS.items() if loader.urdf_filename}
