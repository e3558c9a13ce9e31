"""Meshes that a URDF refers to: finding their files, and simplifying them to the resolution of a screen."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

IndexArray = NDArray[np.int64]

GRID_CELLS = (160, 110, 80, 56, 40)
"""Cells along a mesh's longest side; vertices of one cell become one. A screen does not show more.

The first number that leaves at most :data:`MAX_TRIANGLES` is used."""

MAX_TRIANGLES = 20_000
"""Largest number of triangles of a mesh."""

CREASE = np.cos(np.deg2rad(40.0))
"""Cosine of the crease angle: faces that meet at a larger angle keep a sharp edge."""


class Mesh(NamedTuple):
    """Triangles with a normal at each vertex.

    Attributes:
        points: Vertices [m], (V, 3).
        normals: Unit normal at each vertex, (V, 3).
        triangles: Indices of three vertices each, (F, 3).
    """

    points: FloatArray
    normals: FloatArray
    triangles: IndexArray


def find_mesh(name: str, folder: Path | None) -> Path | None:
    """Find the file of a mesh.

    Args:
        name: Name in the URDF: a path, ``file://…``, or ``package://package/…``.
        folder: Folder of the URDF, of the package, or of several packages. ROS_PACKAGE_PATH and AMENT_PREFIX_PATH are
            searched too.

    Returns:
        Path of the file, or None if it does not exist.
    """
    folders = [] if folder is None else [folder.resolve(), *folder.resolve().parents]
    if name.startswith("package://"):
        folders += [Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(":") if p]
        folders += [Path(p) / "share" for p in os.environ.get("AMENT_PREFIX_PATH", "").split(":") if p]
        package, _, rest = name.removeprefix("package://").partition("/")
        candidates = [place / package / rest for place in folders]
        candidates += [place / rest for place in folders if place.name == package]
    else:
        plain = name.removeprefix("file://")
        candidates = [place / plain for place in folders[:1]] or [Path(plain)]
    return next((path for path in candidates if path.is_file()), None)


def load_mesh(path: Path, scale: FloatArray) -> Mesh:
    """Read a mesh (STL, DAE, OBJ, ...), simplified to the resolution of a screen.

    Args:
        path: Path of the file.
        scale: Scale along x, y and z, (3,).

    Returns:
        The mesh.

    Raises:
        ValueError: The file is not a mesh that Assimp can read.
    """
    read = coal.MeshLoader().load(str(path.resolve()), scale)
    indices = [read.tri_indices(i) for i in range(read.num_tris)]
    triangles = np.array([(t[0], t[1], t[2]) for t in indices])
    vertices = np.asarray(read.vertices())
    for cells in GRID_CELLS:
        points, simplified = _simplify(vertices, triangles, cells)
        if len(simplified) <= MAX_TRIANGLES:
            break
    return _with_normals(points, simplified)


def _simplify(points: FloatArray, triangles: IndexArray, grid_cells: int) -> tuple[FloatArray, IndexArray]:
    """Cluster the vertices in each cell of a grid, and drop triangles that degenerate."""
    cell = float(np.ptp(points, axis=0).max()) / grid_cells
    cells = np.rint((points - points.min(axis=0)) / cell).astype(int)
    _, owner, counts = np.unique(_keys(cells), return_inverse=True, return_counts=True)
    owner = owner.ravel()
    means = np.column_stack([np.bincount(owner, points[:, axis]) for axis in range(3)]) / counts[:, np.newaxis]
    faces = owner[triangles]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(_keys(np.sort(faces, axis=1)), return_index=True)
    return means, faces[np.sort(first)]


def _with_normals(points: FloatArray, triangles: IndexArray) -> Mesh:
    """Give every corner of a triangle the mean normal of the adjacent faces that it does not meet at a crease."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    unit = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-30)
    corner_points, corner_faces = triangles.ravel(), np.repeat(np.arange(len(triangles)), 3)
    order = np.argsort(corner_points, kind="stable")
    starts = np.searchsorted(corner_points[order], np.arange(len(points) + 1))
    counts = np.diff(starts)[corner_points]  # faces at the point of each corner
    corner = np.repeat(np.arange(len(corner_points)), counts)
    within = np.arange(len(corner)) - np.repeat(np.cumsum(counts) - counts, counts)
    other = corner_faces[order[starts[corner_points[corner]] + within]]
    smooth = np.einsum("ij,ij->i", unit[corner_faces[corner]], unit[other]) > CREASE
    normals: FloatArray = np.column_stack([np.bincount(corner, areas[other, k] * smooth) for k in range(3)])
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    keys = np.column_stack([corner_points, np.rint(normals * 50.0).astype(int) + 50])
    _, first, owner = np.unique(_keys(keys), return_index=True, return_inverse=True)
    return Mesh(points[corner_points[first]], normals[first], owner.reshape(-1, 3))


def _keys(rows: IndexArray) -> IndexArray:
    """Encode rows of non-negative numbers as one number each, which sorts faster."""
    keys = np.zeros(len(rows), dtype=np.int64)
    for column in rows.T:
        keys = keys * (int(column.max(initial=0)) + 1) + column
    return keys
