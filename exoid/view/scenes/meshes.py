"""Meshes that a URDF refers to: trimesh reads them, simplifies them to the resolution of a screen, and shades them.

All of that happens in the child process that reads files: a damaged file ends that process, not the caller.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.tools.file_bounds import reading
from exoid.tools.reader_process import read_in_child

from .visual import hex_colour

if TYPE_CHECKING:
    from trimesh import Trimesh

MAX_TRIANGLES = 20_000
"""Largest number of triangles of a mesh."""

SMALLEST_SCALE, LARGEST_MESH = 1e-9, 1e6
"""Smallest scale of a mesh, and largest size of one [m]."""


class Mesh(NamedTuple):
    """Triangles of one colour, with a normal at each vertex."""

    points: FloatArray  # vertices [m], (V, 3)
    normals: FloatArray  # unit normal at each vertex, (V, 3)
    triangles: NDArray[np.int64]  # indices of three vertices each, (F, 3)
    colour: str | None  # colour in the file as "#rrggbb", or None


def load_mesh(path: Path, scale: FloatArray) -> tuple[Mesh, ...]:
    """Read a mesh, simplified to the resolution of a screen."""
    if not (np.isfinite(scale).all() and (np.abs(scale) >= SMALLEST_SCALE).all() and (np.abs(scale) <= 1e9).all()):
        raise ValueError(f"scale {' '.join(f'{each:g}' for each in scale)}")
    return tuple(read_in_child(read_mesh, str(path.resolve()), scale=scale.tolist()))


def read_mesh(file: str, scale: list[float]) -> list[Mesh]:
    """Read a mesh in this process, which a damaged file may end."""
    from trimesh.geometry import mean_vertex_normals  # noqa: PLC0415 - trimesh takes half a second
    from trimesh.graph import smooth_shade  # noqa: PLC0415

    found = []
    with reading("a mesh", "export it again, as STL, OBJ, DAE or GLB"):
        for colour, part in _simplified(_parts(file, scale)).items():
            # Crease angle [rad]: faces that meet at a larger angle keep a sharp edge.
            shaded = smooth_shade(part, angle=np.deg2rad(40.0), facet_minarea=None)
            areas = shaded.face_normals * shaded.area_faces[:, np.newaxis]  # so that rounded edges leave faces flat
            normals = mean_vertex_normals(len(shaded.vertices), shaded.faces, areas)
            points = np.array(shaded.vertices, dtype=np.float64)
            found.append(Mesh(points, normals, np.array(shaded.faces, dtype=np.int64), colour))
    return found


def _parts(file: str, scale: list[float]) -> dict[str | None, Trimesh]:
    """Read a file; the triangles of one colour are one part."""
    import trimesh  # noqa: PLC0415

    by_colour: dict[str | None, list[Trimesh]] = {}
    meshes = trimesh.load_scene(file, process=False).dump()  # each in its place
    found = [mesh for mesh in meshes if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    if not found:
        raise ValueError("no triangles")
    for mesh in found:
        if not np.isfinite(mesh.vertices).all():
            raise ValueError("vertices that are not finite numbers")
        if not 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices):
            raise ValueError(f"triangles of vertices that do not exist: {mesh.faces.max()} of {len(mesh.vertices)}")
        bare = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        by_colour.setdefault(_colour(mesh), []).append(bare.apply_scale(scale))
    parts = {colour: trimesh.util.concatenate(meshes) for colour, meshes in by_colour.items()}
    size = _size(parts)
    if not 0.0 < size <= LARGEST_MESH:
        raise ValueError(f"its size is {size:.3g} m")
    return parts


def _colour(mesh: Trimesh) -> str | None:
    """Colour of a mesh in its file as "#rrggbb": the most frequent one, and the mean of a picture; or None."""
    if not mesh.visual.defined:
        return None
    material = getattr(mesh.visual, "material", None)
    picture = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if picture is not None:
        red, green, blue = picture.convert("RGB").resize((1, 1)).getpixel((0, 0))
    else:
        red, green, blue = (mesh.visual if material is None else material).main_color[:3]
    return hex_colour(red, green, blue)


def _size(parts: Mapping[str | None, Trimesh]) -> float:
    """Longest side of the box around a mesh [m]."""
    corners = np.array([part.bounds for part in parts.values()])
    return float(np.max(corners[:, 1].max(axis=0) - corners[:, 0].min(axis=0)))


def _simplified(parts: Mapping[str | None, Trimesh]) -> dict[str | None, Trimesh]:
    """Merge the vertices in each cell of a grid, as fine as :data:`MAX_TRIANGLES` allows."""
    size = _size(parts)
    for cells in (160, 110, 80, 56, 40):  # along the longest side: a screen does not show more
        kept, cell = {}, size / cells
        for colour, part in parts.items():
            merged = part.copy().apply_scale(1.0 / cell)
            merged.merge_vertices(digits_vertex=0)  # of equal coordinates after rounding
            merged.update_faces(merged.nondegenerate_faces())
            merged.update_faces(merged.unique_faces())
            if len(merged.faces):
                kept[colour] = merged.apply_scale(cell)
        if sum(len(part.faces) for part in kept.values()) <= MAX_TRIANGLES:
            break
    if not kept:
        raise ValueError("all triangles are lines or points")
    return kept
