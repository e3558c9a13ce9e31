"""Built-in legs and their URDFs."""

from __future__ import annotations

from pathlib import Path

from .errors import ExoidError
from .leg import Leg

SEGMENTS = {"bleex": ("hip", "knee", "ankle"), "cuhk": ("hip", "knee")}

URDFS = {
    ("bleex", "cad"): "bleex.urdf",
    ("bleex", "identified"): "bleex_identified.urdf",
    ("cuhk", "nominal"): "cuhk.urdf",
}
"""File of each leg and inertia set."""


def urdf_folder() -> Path:
    """Find the folder of the built-in URDFs: inside the package when installed, beside it in a source tree.

    Returns:
        The folder.

    Raises:
        ExoidError: It is in neither place: the installation is incomplete.
    """
    package = Path(__file__).resolve().parent
    for folder in (package / "urdf", package.parent / "urdf"):
        if (folder / "bleex.urdf").is_file():
            return folder
    raise ExoidError("the built-in URDFs are missing", where=str(package), remedy="reinstall exoid")


def load_leg(name: str, side: str = "left", inertias: str | None = None) -> Leg:
    """Load a built-in leg.

    Args:
        name: "bleex" (document 1, hip, knee and ankle) or "cuhk" (document 2, hip and knee).
        side: "left" or "right".
        inertias: For "bleex": "cad" (Table V, default) or "identified" (Tables II-III of that side). For "cuhk":
            "nominal", an anthropometric plant, as the document's Table III is not a physical leg.

    Returns:
        The leg; its J are cumulative for "bleex" and not for "cuhk", as the documents define them.

    Raises:
        ExoidError: There is no such leg, side or inertia set.

    Example:
        >>> load_leg("bleex", side="right", inertias="identified").joint_names
        ('right_hip', 'right_knee', 'right_ankle')
    """
    if name not in SEGMENTS:
        raise ExoidError(f"no built-in leg {name!r}", remedy=f"use one of {', '.join(SEGMENTS)}, or Leg.from_urdf")
    sets = [known for leg, known in URDFS if leg == name]
    inertias = sets[0] if inertias is None else inertias
    if inertias not in sets:
        raise ExoidError(f"no inertias {inertias!r} for {name!r}", remedy=f"use one of {', '.join(sets)}")
    if side not in ("left", "right"):
        raise ExoidError(f"no side {side!r}", remedy="use 'left' or 'right'")
    joints = tuple(f"{side}_{segment}" for segment in SEGMENTS[name])
    return Leg.from_urdf(urdf_folder() / URDFS[name, inertias], joints, cumulative=name == "bleex")
