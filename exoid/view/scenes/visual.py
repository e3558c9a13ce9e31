"""Visuals: geometries with a placement and a material, and their description for three.js, which draws them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray

SEGMENTS = 32
"""Number of edges that approximate a circle."""

Y_TO_Z = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Transform that turns three.js's cylinders from the y axis to the z axis."""


@dataclass(frozen=True)
class Material:
    """Surface of a visual."""

    colour: str  # colour as "#rrggbb"
    opacity: float = 1.0  # opacity; 1 for solid
    # "gloss", "matte", or "flat" for a surface that looks the same in any light
    finish: Literal["gloss", "matte", "flat"] = "gloss"

    def to_threejs(self) -> dict[str, Any]:
        """Describe the material in three.js's format."""
        kind = {"gloss": "MeshPhongMaterial", "matte": "MeshLambertMaterial", "flat": "MeshBasicMaterial"}[self.finish]
        material: dict[str, Any] = {"type": kind, "color": int(self.colour[1:], 16), "side": 2}
        if self.finish == "gloss":
            material |= {"shininess": 40, "specular": 0x333333}
        if self.opacity < 1.0:
            material |= {"transparent": True, "opacity": self.opacity, "depthWrite": False}
        return material


@dataclass(frozen=True, eq=False)
class Visual:
    """A geometry with a placement and a material, as the ``<visual>`` element of a URDF."""

    geometry: Mapping[str, Any]  # geometry in three.js's format
    transform: FloatArray  # transform from the geometry's frame to the frame in which it is drawn, (4, 4); may scale
    material: Material  # surface
    corners: FloatArray  # points of the geometry's frame whose convex hull contains it, (k, 3)

    def placed(self, transform: FloatArray) -> Visual:
        """Return the visual in another frame, given the transform to that frame, (4, 4)."""
        return replace(self, transform=transform @ self.transform)

    @property
    def bounding_points(self) -> FloatArray:
        """Points of the frame in which it is drawn whose convex hull contains it [m], (k, 3)."""
        return np.asarray(self.corners @ self.transform[:3, :3].T + self.transform[:3, 3])


def box(size: ArrayLike, material: Material) -> Visual:
    """Make a box with edges along x, y and z [m], (3,), centred at the origin."""
    x, y, z = (float(s) for s in np.asarray(size, dtype=np.float64))
    geometry = {"type": "BoxGeometry", "width": x, "height": y, "depth": z}
    return Visual(geometry, np.eye(4), material, _corners((x, y, z)))


def cylinder(radius: float, length: float, material: Material, *, top_radius: float | None = None) -> Visual:
    """Make a cylinder along z [m], centred at the origin, or a cone with another radius at its upper end."""
    geometry = {
        "type": "CylinderGeometry",
        "radiusTop": radius if top_radius is None else top_radius,
        "radiusBottom": radius,
        "height": length,
        "radialSegments": SEGMENTS,
    }
    return Visual(geometry, Y_TO_Z, material, _corners((2.0 * radius, length, 2.0 * radius)))


def ellipsoid(semi_axes: ArrayLike, material: Material) -> Visual:
    """Make an ellipsoid with semi-axes [m], (3,), or a sphere with one radius, centred at the origin."""
    geometry = {"type": "SphereGeometry", "radius": 1.0, "widthSegments": SEGMENTS, "heightSegments": SEGMENTS // 2}
    transform = np.diag([*np.broadcast_to(semi_axes, 3), 1.0])
    return Visual(geometry, transform, material, _corners((2.0, 2.0, 2.0)))


def torus(radius: float, tube_radius: float, arc: float, material: Material) -> Visual:
    """Make a torus [m] around z, or the part of it from the x axis over an angle ``arc`` [rad]."""
    geometry = {
        "type": "TorusGeometry",
        "radius": radius,
        "tube": tube_radius,
        "radialSegments": 12,
        "tubularSegments": 2 * SEGMENTS,
        "arc": arc,
    }
    width = 2.0 * (radius + tube_radius)
    return Visual(geometry, np.eye(4), material, _corners((width, width, 2.0 * tube_radius)))


def triangle_mesh(points: FloatArray, normals: FloatArray, triangles: NDArray[np.int64], material: Material) -> Visual:
    """Make a mesh of triangles."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    step = float(np.max(upper - lower)) / 8191.0 or 1.0  # small integers as coordinates make shorter files
    grid = np.rint((points - lower) / step).astype(int)
    attributes = {
        "position": {"itemSize": 3, "type": "Float32Array", "array": grid.ravel().tolist()},
        "normal": {"itemSize": 3, "type": "Float32Array", "array": np.round(normals, 2).ravel().tolist()},
    }
    index = {"type": "Uint32Array", "array": triangles.ravel().tolist()}
    transform = np.diag([step, step, step, 1.0])
    transform[:3, 3] = lower
    geometry = {"type": "BufferGeometry", "data": {"attributes": attributes, "index": index}}
    return Visual(geometry, transform, material, _corners(grid.max(axis=0)) + 0.5 * grid.max(axis=0))


def to_threejs(visuals: Sequence[Visual], *, shadows: bool = True) -> dict[str, Any]:
    """Describe visuals as one object in three.js's format; shared geometries and materials are written once."""
    geometries: dict[int, str] = {}
    materials: dict[Material, str] = {}
    children = [
        {
            "uuid": f"mesh-{number}",
            "type": "Mesh",
            "geometry": geometries.setdefault(id(visual.geometry), f"geometry-{len(geometries)}"),
            "material": materials.setdefault(visual.material, f"material-{len(materials)}"),
            "matrix": [float(f"{value:g}") for value in visual.transform.T.ravel()],
            "castShadow": shadows and visual.material.opacity == 1.0,
            "receiveShadow": shadows and visual.material.finish != "flat",
        }
        for number, visual in enumerate(visuals)
    ]
    by_id = {id(visual.geometry): visual.geometry for visual in visuals}
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": uuid, **by_id[key]} for key, uuid in geometries.items()],
        "materials": [{"uuid": uuid, **material.to_threejs()} for material, uuid in materials.items()],
        "object": {"uuid": "group", "type": "Group", "children": children},
    }


def hex_colour(red: int, green: int, blue: int) -> str:
    """Write a colour of three numbers from 0 to 255 as "#rrggbb"."""
    return f"#{red:02x}{green:02x}{blue:02x}"


def _corners(size: Iterable[float]) -> FloatArray:
    """Corners of a box centred at the origin, (8, 3)."""
    x, y, z = size
    signs = np.array([(i, j, k) for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    return np.asarray(signs * np.array([x, y, z]))
