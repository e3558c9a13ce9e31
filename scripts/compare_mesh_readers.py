"""Compare the bounds of meshes as trimesh and Assimp (in coal) read them.

    python scripts/compare_mesh_readers.py FOLDER   # such as that of example-robot-data, which is found without one

A line names each file that trimesh does not read, or whose bounds differ by more than 1e-6 of its size.
"""

from __future__ import annotations

import logging
import sys
from pathlib import Path

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray

ENDINGS = (".stl", ".dae", ".obj", ".glb", ".ply")
LARGEST = 20e6
"""Largest size of a file [bytes]: the comparison would take hours with the few larger ones."""


def by_trimesh(path: Path) -> NDArray[np.float64] | None:
    """Read the lower and upper corner of a mesh by trimesh, (2, 3); None if it has no triangles."""
    bounds = trimesh.load_scene(str(path), process=False).bounds
    return None if bounds is None else np.asarray(bounds)


def by_assimp(path: Path) -> NDArray[np.float64]:
    """Read the lower and upper corner of a mesh by Assimp, (2, 3)."""
    vertices = np.array(coal.MeshLoader().load(str(path), np.ones(3)).vertices())
    return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def example_robots() -> Path:
    """Find the robots of example-robot-data."""
    from example_robot_data.robots_loader import getModelPath  # noqa: PLC0415 - an extra

    return Path(getModelPath("panda_description/urdf/panda.urdf"))


def main() -> None:
    """Read all meshes below a folder, and print those that differ."""
    logging.disable(logging.CRITICAL)
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else example_robots()
    files = [path for path in sorted(folder.rglob("*")) if path.suffix.lower() in ENDINGS]
    files = [path for path in files if path.stat().st_size <= LARGEST]
    different = 0
    for path in files:
        one, other = by_trimesh(path), by_assimp(path)
        apart = np.inf if one is None else float(np.abs(one - other).max() / np.ptp(other, axis=0).max())
        if not apart <= 1e-6:
            different += 1
            print(f"{path.relative_to(folder)}: bounds differ by {apart:.1g} of its size", flush=True)
    print(f"{len(files)} meshes, {different} with other bounds")


if __name__ == "__main__":
    main()
