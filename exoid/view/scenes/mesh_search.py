"""Files of meshes that a URDF names by a package, by the path of ROS or beside itself; no other is opened."""

from __future__ import annotations

import os
from errno import ENOENT
from pathlib import Path

PACKAGE = "package.xml"
"""File in the folder of a package of ROS."""


def find_mesh(name: str, folder: Path | None) -> Path:
    """Find the file of a mesh below the folder of the URDF, or in a package."""
    # A page with the mesh may be meant for others. So a URDF from elsewhere must not choose any file of this machine:
    # absolute paths, `file://…` and paths with `..` count only if they lead to a file in one of these folders.
    scheme, has_scheme, rest = name.replace("\\", "/").partition("://")
    path = rest if has_scheme else scheme
    here = Path() if folder is None else folder
    try:
        if has_scheme and scheme not in ("file", "package"):
            raise FileNotFoundError(ENOENT, f"{scheme}:// is not opened: save the file beside the URDF")
        found = _in_package(path, here.resolve()) if scheme == "package" else _in_folder(path, here.resolve())
    except (OSError, ValueError) as problem:  # a name that is too long, a null byte, no permission
        reason = getattr(problem, "strerror", None) or problem
        # Number of characters of a name in messages.
        raise FileNotFoundError(f"mesh {name[:200]!r} not found ({reason})") from None
    if found is None:
        raise FileNotFoundError(f"mesh {name!r} not found")
    return found


def _in_folder(name: str, folder: Path) -> Path | None:
    """Find a mesh by its path, in the folder of the URDF and in the package around it."""
    roots = [folder, *(above for above in folder.parents if (above / PACKAGE).is_file())]
    below = [part for part in Path(name).parts if part not in ("..", "/") and not part.endswith(":")]
    for path in (folder / name, folder.joinpath(*below)):
        if path.is_file():
            if any(path.resolve().is_relative_to(root) for root in roots):
                return path
            raise FileNotFoundError(ENOENT, f"it is outside of {folder}: copy it there, or name its folder")
    return None


def _in_package(name: str, here: Path) -> Path | None:
    """Find a mesh of a package; links in packages on the path of ROS may lead elsewhere, as colcon makes them."""
    package, _, rest = name.partition("/")
    if package in ("", ".", "..") or ".." in Path(rest).parts or Path(rest).is_absolute():
        raise FileNotFoundError(ENOENT, "its path leads out of the package")
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
