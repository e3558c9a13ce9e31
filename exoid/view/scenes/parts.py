"""Parts: solids with a place and a colour, and what three.js, which draws them in the browser, calls them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray

DIGITS = 6
"""Significant digits of numbers in the page."""

ROUND = 32
"""Edges of a circle."""

Y_TO_Z = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Turns three.js's cylinders, which stand along y, upright."""


@dataclass(frozen=True)
class Look:
    """Surface of a part.

    Attributes:
        colour: "#rrggbb".
        opacity: 1 for solid.
        finish: "gloss", "matte", or "flat" for what looks the same in any light, such as lines.
        behind: Whether it yields to solids at the same place, as the shape of a second leg does to that of the first.
    """

    colour: str
    opacity: float = 1.0
    finish: Literal["gloss", "matte", "flat"] = "gloss"
    behind: bool = False

    def to_three(self) -> dict[str, Any]:
        """Describe the material in three.js's format."""
        kind = {"gloss": "MeshPhongMaterial", "matte": "MeshLambertMaterial", "flat": "MeshBasicMaterial"}[self.finish]
        material: dict[str, Any] = {"type": kind, "color": int(self.colour[1:], 16), "side": 2}
        if self.finish == "gloss":
            material |= {"shininess": 40, "specular": 0x333333}
        if self.opacity < 1.0:
            material |= {"transparent": True, "opacity": self.opacity, "depthWrite": False}
        if self.behind:
            material |= {"polygonOffset": True, "polygonOffsetFactor": 2, "polygonOffsetUnits": 2}
        return material


@dataclass(frozen=True, eq=False)
class Part:
    """A solid.

    Attributes:
        geometry: In three.js's format.
        place: Where it is in the frame it is drawn in, (4, 4); may scale.
        look: Its surface.
        corners: Points of its own frame whose hull contains it, (k, 3).
    """

    geometry: Mapping[str, Any]
    place: FloatArray
    look: Look
    corners: FloatArray

    def at(self, place: FloatArray) -> Part:
        """Return the part, placed in another frame, (4, 4)."""
        return replace(self, place=place @ self.place)

    def looking(self, look: Look) -> Part:
        """Return the part with another surface."""
        return replace(self, look=look)

    @property
    def extent(self) -> FloatArray:
        """Its corners in the frame it is drawn in, (k, 3)."""
        return np.asarray(self.corners @ self.place[:3, :3].T + self.place[:3, 3])


def box(size: ArrayLike, look: Look) -> Part:
    """Make a box of these edges [m], (3,), around the origin."""
    x, y, z = (float(s) for s in np.asarray(size, dtype=np.float64))
    geometry = {"type": "BoxGeometry", "width": x, "height": y, "depth": z}
    return Part(geometry, np.eye(4), look, _corners((x, y, z)))


def cylinder(radius: float, length: float, look: Look, *, tip: float | None = None) -> Part:
    """Make a cylinder along z around the origin, or a cone with another radius at its upper end."""
    geometry = {
        "type": "CylinderGeometry",
        "radiusTop": radius if tip is None else tip,
        "radiusBottom": radius,
        "height": length,
        "radialSegments": ROUND,
    }
    return Part(geometry, Y_TO_Z, look, _corners((2.0 * radius, length, 2.0 * radius)))


def ellipsoid(axes: ArrayLike, look: Look) -> Part:
    """Make an ellipsoid with these semi-axes [m], (3,), or one radius, around the origin."""
    geometry = {"type": "SphereGeometry", "radius": 1.0, "widthSegments": ROUND, "heightSegments": ROUND // 2}
    return Part(geometry, np.diag([*np.broadcast_to(axes, 3), 1.0]), look, _corners((2.0, 2.0, 2.0)))


def ring(radius: float, tube: float, arc: float, look: Look) -> Part:
    """Make a piece of a ring around z, from the x axis on over an angle [rad]."""
    geometry = {
        "type": "TorusGeometry",
        "radius": radius,
        "tube": tube,
        "radialSegments": 12,
        "tubularSegments": 2 * ROUND,
        "arc": arc,
    }
    wide = 2.0 * (radius + tube)
    return Part(geometry, np.eye(4), look, _corners((wide, wide, 2.0 * tube)))


def surface(points: FloatArray, normals: FloatArray, triangles: NDArray[np.int64], look: Look) -> Part:
    """Make a surface of triangles: points [m], (V, 3), their normals, (V, 3), and three points each, (F, 3)."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    step = float(np.max(upper - lower)) / 8191.0 or 1.0  # coordinates become small whole numbers: shorter files
    grid = np.rint((points - lower) / step).astype(int)
    attributes = {
        "position": {"itemSize": 3, "type": "Float32Array", "array": grid.ravel().tolist()},
        "normal": {"itemSize": 3, "type": "Float32Array", "array": np.round(normals, 2).ravel().tolist()},
    }
    index = {"type": "Uint32Array", "array": triangles.ravel().tolist()}
    place = np.diag([step, step, step, 1.0])
    place[:3, 3] = lower
    geometry = {"type": "BufferGeometry", "data": {"attributes": attributes, "index": index}}
    return Part(geometry, place, look, _corners(grid.max(axis=0)) + 0.5 * grid.max(axis=0))


def moved(xyz: ArrayLike, rotation: FloatArray | None = None) -> FloatArray:
    """Place at a point [m] with an orientation, (4, 4)."""
    place = np.eye(4)
    place[:3, 3] = np.asarray(xyz, dtype=np.float64)
    if rotation is not None:
        place[:3, :3] = rotation
    return place


def towards(direction: ArrayLike, beside: ArrayLike = (0.0, 1.0, 0.0)) -> FloatArray:
    """Rotation whose z axis is a direction and whose y axis is as near as can be to another, (3, 3)."""
    z = np.asarray(direction, dtype=np.float64)
    z = z / np.linalg.norm(z)
    y = np.asarray(beside, dtype=np.float64)
    if np.linalg.norm(np.cross(y, z)) < 1e-6 * np.linalg.norm(y):
        y = np.eye(3)[np.argmin(np.abs(z))]
    x = np.cross(y, z)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def to_three(parts: Sequence[Part], *, shadows: bool = True) -> dict[str, Any]:
    """Describe parts as one object in three.js's format, equal geometries and surfaces once."""
    geometries: dict[int, str] = {}
    looks: dict[Look, str] = {}
    children = [
        {
            "uuid": f"mesh-{number}",
            "type": "Mesh",
            "geometry": geometries.setdefault(id(part.geometry), f"geometry-{len(geometries)}"),
            "material": looks.setdefault(part.look, f"look-{len(looks)}"),
            "matrix": _numbers(part.place.T.ravel()),
            "castShadow": shadows and part.look.opacity == 1.0,
            "receiveShadow": shadows and part.look.finish != "flat",
        }
        for number, part in enumerate(parts)
    ]
    of_ids = {id(part.geometry): part.geometry for part in parts}
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": uuid, **of_ids[key]} for key, uuid in geometries.items()],
        "materials": [{"uuid": uuid, **look.to_three()} for look, uuid in looks.items()],
        "object": {"uuid": "group", "type": "Group", "children": children},
    }


def _corners(size: Iterable[float]) -> FloatArray:
    x, y, z = size
    signs = np.array([(i, j, k) for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    return np.asarray(signs * np.array([x, y, z]))


def _numbers(values: FloatArray) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
