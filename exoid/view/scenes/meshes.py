"""Meshes that a URDF refers to: finding their files, and simplifying them to the resolution of a screen."""

from __future__ import annotations

import os
from errno import ENOENT
from pathlib import Path
from typing import NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.reader_process import Content, read_in_child

IndexArray = NDArray[np.int64]

GRID_CELLS = (160, 110, 80, 56, 40)
"""Cells along a mesh's longest side; vertices of one cell become one. A screen does not show more.

The first number that leaves at most :data:`MAX_TRIANGLES` is used."""

MAX_TRIANGLES = 20_000
"""Largest number of triangles of a mesh."""

PACKAGE = "package.xml"
"""File in the folder of a package of ROS."""

LONGEST_NAME = 200
"""Number of characters of a name in messages."""

SMALLEST_SCALE, LARGEST_MESH = 1e-9, 1e6
"""Smallest scale of a mesh, and largest coordinate of its vertices [m]."""

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


def find_mesh(name: str, folder: Path | None) -> Path:
    """Find the file of a mesh below the folder of the URDF, or in a package.

    A page with the mesh may be meant for others. So a URDF from elsewhere must not choose any file of this machine:
    absolute paths, ``file://…`` and paths with ``..`` count only if they lead to a file in one of these folders.

    Args:
        name: Name in the URDF: a path, ``file://…``, or ``package://package/…``.
        folder: Folder of the URDF, of the package, or of several packages; None for the present folder. If a folder
            above it is a package (with package.xml, or its parent with the package's name), that is searched too, and
            so are ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.

    Returns:
        Path of the file.

    Raises:
        FileNotFoundError: There is no such file in these folders; says whether it is outside.
    """
    try:
        here = Path() if folder is None else folder
        found = _in_package(name, here) if name.startswith("package://") else _in_folder(name, here.resolve())
    except (OSError, ValueError) as problem:  # a name that is too long, a null byte, no permission
        reason = getattr(problem, "strerror", None) or problem
        raise FileNotFoundError(f"mesh {name[:LONGEST_NAME]!r} not found ({reason})") from None
    if found is None:
        raise FileNotFoundError(f"mesh {name!r} not found")
    return found


def _in_folder(name: str, folder: Path) -> Path | None:
    """Find a mesh by its path, in the folder of the URDF and in the package around it."""
    path = folder / name.removeprefix("file://")
    roots = [folder, *(above for above in folder.parents if (above / PACKAGE).is_file())]
    if path.is_file() and not any(path.resolve().is_relative_to(root) for root in roots):
        raise FileNotFoundError(ENOENT, f"it is outside of {folder}: copy it there, or name its folder")
    parts = Path(name.removeprefix("file://")).parts
    plain = folder.joinpath(*(part for part in parts if part not in ("..", "/")))
    return next((each for each in (path, plain) if each.is_file()), None)


def _in_package(name: str, folder: Path) -> Path | None:
    """Find a mesh of a package; links in packages on the path of ROS may lead elsewhere, as colcon makes them."""
    package, _, rest = name.removeprefix("package://").partition("/")
    if package in ("", ".", "..") or ".." in Path(rest).parts or Path(rest).is_absolute():
        raise FileNotFoundError(ENOENT, "its path leads out of the package")
    here = folder.resolve()
    named = [above for above in (here, *here.parents) if above.name == package]
    inside = [
        here / package,
        *(above for above in named if above in (here, here.parent) or (above / PACKAGE).is_file()),
    ]
    beside = [above / package for above in here.parents if (above / package / PACKAGE).is_file()]
    for root in (*inside, *beside):
        path = root / rest
        if path.is_file() and path.resolve().is_relative_to(root):
            return path
    listed = [Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if p]
    listed += [Path(p) / "share" for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    candidates = [place / package / rest for place in listed]
    candidates += [place / rest for place in listed if place.name == package]
    return next((path for path in candidates if path.is_file()), None)


def load_mesh(path: Path, scale: FloatArray) -> Mesh:
    """Read a mesh (STL, DAE, OBJ, ...), simplified to the resolution of a screen.

    Args:
        path: Path of the file.
        scale: Scale along x, y and z, (3,).

    Returns:
        The mesh.

    Raises:
        ValueError: The scale is zero or far from one, or the file is not a mesh of finite numbers.
        ExoidError: The file ends the process that reads it.
    """
    if not (np.isfinite(scale).all() and (np.abs(scale) >= SMALLEST_SCALE).all() and (np.abs(scale) <= 1e9).all()):
        raise ValueError(f"scale {' '.join(f'{each:g}' for each in scale)}")
    arrays = read_in_child(mesh_arrays, str(path.resolve()), scale=scale.tolist()).arrays
    vertices, triangles = arrays["vertices"], arrays["triangles"]
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(vertices):
        raise ValueError(f"triangles of vertices that do not exist: {triangles.max()} of {len(vertices)}")
    if not len(triangles) or not np.isfinite(vertices).all() or np.abs(vertices).max() > LARGEST_MESH:
        raise ValueError(f"no triangles, or vertices beyond {LARGEST_MESH:.0e} m")
    if not np.ptp(vertices, axis=0).max() > 0.0:
        raise ValueError("all vertices are one point")
    for cells in GRID_CELLS:
        points, simplified = _simplify(vertices, triangles, cells)
        if len(simplified) <= MAX_TRIANGLES:
            break
    return _with_normals(points, simplified)


def mesh_arrays(file: str, scale: list[float]) -> Content:
    """Read a mesh in this process, which a damaged file may end.

    Args:
        file: Path of the file.
        scale: Scale along x, y and z.

    Returns:
        ``vertices`` [m], (V, 3), and ``triangles``, indices of three vertices each, (F, 3).
    """
    read = coal.MeshLoader().load(file, np.array(scale))
    indices = [read.tri_indices(i) for i in range(read.num_tris)]
    triangles = np.array([(t[0], t[1], t[2]) for t in indices], dtype=np.int64).reshape(-1, 3)
    return Content({"vertices": np.array(read.vertices(), dtype=np.float64).reshape(-1, 3), "triangles": triangles})


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
