"""Surroundings of the legs in a scene: background, ground, light and camera."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray

from .commands import ROOT, Command, set_object, set_property, set_transform
from .leg_geometry import LegGeometry
from .scene import Camera
from .transforms import align_z, homogeneous
from .visual import Material, Visual, box, cylinder

LINES = Material("#b9bfc8", finish="flat")

SMALLEST = 0.01
"""Smallest half size of the visible volume [m]."""


def view_direction(geometries: Sequence[LegGeometry]) -> FloatArray:
    """Direction from the legs to the camera, (3,): the outer side of one leg, more from the front of several."""
    torsos = [point for geometry in geometries for visual in geometry.visuals[0] for point in visual.bounding_points]
    middle = np.mean([*torsos, np.zeros(3)], axis=0)
    hips = np.mean([geometry.skeleton.placements[0][:3, 3] for geometry in geometries], axis=0)
    side = -1.0 if hips[1] < middle[1] - 1e-3 else 1.0
    direction = np.array([0.62, 0.78 * side, 0.22] if len(geometries) == 1 else [0.87, 0.44, 0.22])
    return np.asarray(direction / np.linalg.norm(direction))


def camera(points: FloatArray, direction: FloatArray) -> Camera:
    """Camera that sees all points."""
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    axes = align_z(direction, (0.0, 0.0, 1.0))  # to the right of the picture, upwards, to the camera
    extent = np.abs((points - centre) @ axes).max(axis=0)
    half_width, half_height, half_depth = np.maximum(extent, SMALLEST).tolist()
    return Camera(tuple(centre.tolist()), tuple(direction.tolist()), half_width, half_height, half_depth)


def draw_surroundings(points: FloatArray, direction: FloatArray, floor: float | None = None) -> Iterator[Command]:
    """Commands that draw background and ground and set light and camera."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    centre, size = 0.5 * (lower + upper), max(float(np.linalg.norm(upper - lower)), SMALLEST)
    for name, value in (("top_color", [1.0, 1.0, 1.0]), ("bottom_color", [0.9, 0.91, 0.93])):
        yield set_property("/Background", name, value)
    for path in ("/Grid", "/Axes"):
        yield set_property(path, "visible", False)
    height = lower[2] - 0.002 * size if floor is None else floor
    yield set_object(f"{ROOT}/ground", _ground(size))
    yield set_transform(f"{ROOT}/ground", homogeneous((centre[0], centre[1], height)))
    spot = "/Lights/SpotLight/<object>"
    above = size * np.array([0.6 * direction[0], 0.5 * direction[1], 1.6]) + centre
    yield set_property("/Lights/SpotLight", "visible", True)
    yield set_property(spot, "castShadow", True)
    for light, intensity in (("AmbientLight", 0.5), ("FillLight", 0.2), ("SpotLight", 0.3)):
        yield set_property(f"/Lights/{light}/<object>", "intensity", intensity)
    yield set_property(spot, "position", above.tolist())
    # A field of view of 28° is nearly a parallel projection, so that lengths can be compared.
    view = {"uuid": "camera", "type": "PerspectiveCamera", "fov": 28, "aspect": 1.5, "near": 0.01, "far": 200}
    whole = {"metadata": {"version": 4.5, "type": "Object"}, "object": view}
    yield {"type": "set_object", "path": "/Cameras/default/rotated", "object": whole}


def _ground(size: float) -> list[Visual]:
    """Make a disc with a grid of lines."""
    radius, thickness = 0.5 * size, 0.002 * size
    step = max(each for each in (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0) if each <= max(0.3 * radius, 0.01))
    disc = cylinder(radius, thickness, Material("#c8ced6", finish="matte")).placed(
        homogeneous((0.0, 0.0, -0.5 * thickness))
    )
    lines = []
    for offset in np.arange(-np.floor(radius / step), np.floor(radius / step) + 1.0) * step:
        length = 2.0 * float(np.sqrt(max(radius**2 - offset**2, 0.0)))
        lines.append(box((length, thickness, 0.2 * thickness), LINES).placed(homogeneous((0.0, offset, 0.0))))
        lines.append(box((thickness, length, 0.2 * thickness), LINES).placed(homogeneous((offset, 0.0, 0.0))))
    return [disc, *lines]
