"""Meshes that a URDF refers to: where they lie, and what is left of them at the size of a screen."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

IndexArray = NDArray[np.int64]

FINENESS = (160.0, 110.0, 80.0, 56.0, 40.0)
"""Points closer than a mesh's size over this become one: a screen does not show more. The first that leaves no more
than :data:`MOST` triangles is taken."""

MOST = 20_000
"""Triangles of a mesh."""

CREASE = np.cos(np.deg2rad(40.0))
"""Faces that meet at a sharper angle keep their edge."""


class Mesh(NamedTuple):
    """Triangles with a normal at each of their points.

    Attributes:
        points: [m], (V, 3).
        normals: (V, 3).
        triangles: Three points each, (F, 3).
    """

    points: FloatArray
    normals: FloatArray
    triangles: IndexArray


def find_mesh(name: str, folder: Path | None) -> Path | None:
    """Find the file that a URDF calls a mesh; None where it is not.

    Args:
        name: A path, ``file://…``, or ``package://package/…``.
        folder: Where the URDF is, or the package, or a folder of packages; ROS_PACKAGE_PATH and AMENT_PREFIX_PATH are
            searched too.
    """
    places = [] if folder is None else [folder.resolve(), *folder.resolve().parents]
    if name.startswith("package://"):
        places += [Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(":") if p]
        places += [Path(p) / "share" for p in os.environ.get("AMENT_PREFIX_PATH", "").split(":") if p]
        package, _, rest = name.removeprefix("package://").partition("/")
        tries = [place / package / rest for place in places]
        tries += [place / rest for place in places if place.name == package]
    else:
        plain = name.removeprefix("file://")
        tries = [place / plain for place in places[:1]] or [Path(plain)]
    return next((path for path in tries if path.is_file()), None)


def load_mesh(path: Path, scale: FloatArray) -> Mesh:
    """Read a mesh (STL, DAE, OBJ, ...), as coarse as a screen allows.

    Args:
        path: The file.
        scale: Along x, y and z, (3,).

    Raises:
        Exception: Whatever the reader throws at a file that is no mesh.
    """
    read = coal.MeshLoader().load(str(path.resolve()), scale)
    indices = [read.tri_indices(i) for i in range(read.num_tris)]
    triangles = np.array([(t[0], t[1], t[2]) for t in indices])
    coarser = (_coarser(np.asarray(read.vertices()), triangles, fineness) for fineness in FINENESS)
    joined, left = next(coarser)
    while len(left) > MOST and (pair := next(coarser, None)) is not None:
        joined, left = pair
    return _with_normals(joined, left)


def _coarser(points: FloatArray, triangles: IndexArray, fineness: float) -> tuple[FloatArray, IndexArray]:
    """Join points of one cell of a grid, and drop the triangles that vanish with them."""
    cell = float(np.ptp(points, axis=0).max()) / fineness
    cells = np.rint((points - points.min(axis=0)) / cell).astype(int)
    _, owner, counts = np.unique(_keys(cells), return_inverse=True, return_counts=True)
    owner = owner.ravel()
    joined = np.column_stack([np.bincount(owner, points[:, axis]) for axis in range(3)]) / counts[:, np.newaxis]
    faces = owner[triangles]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(_keys(np.sort(faces, axis=1)), return_index=True)
    return joined, faces[np.sort(first)]


def _with_normals(points: FloatArray, triangles: IndexArray) -> Mesh:
    """Give every corner of a triangle the mean normal of the faces there that it does not meet at a crease."""
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
    """One number for each row of numbers that are not negative: sorting those is quick."""
    keys = np.zeros(len(rows), dtype=np.int64)
    for column in rows.T:
        keys = keys * (int(column.max(initial=0)) + 1) + column
    return keys
