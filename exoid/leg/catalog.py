"""Built-in legs and the folder of their URDFs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from exoid.errors import BadArgumentError, UnreadableInputError

from .leg import Leg
from .leg_data import Base, Contact

SEGMENTS = {"bleex": ("hip", "knee", "ankle"), "cuhk": ("hip", "knee")}
"""Joint labels of each leg."""

URDFS = {
    ("bleex", "cad"): "bleex.urdf",
    ("bleex", "identified"): "bleex_identified.urdf",
    ("cuhk", "nominal"): "cuhk.urdf",
}
"""URDF of each leg and inertia set."""


def urdf_folder() -> Path:
    """Find the folder of the built-in URDFs, inside an installed package or beside it in a source tree."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "urdf", package.parent / "urdf"):
        if (folder / "bleex.urdf").is_file():
            return folder
    raise UnreadableInputError("the built-in URDFs are missing", where=str(package), remedy="reinstall exoid")


def load_leg(name: str, side: str = "left", inertias: str | None = None, *, base: Base = "fixed") -> Leg:
    """Load a built-in leg.

    Args:
        name: Name: "bleex" (document 1, hip, knee and ankle) or "cuhk" (document 2, hip and knee).
        side: "left" or "right".
        inertias: Inertia set. For "bleex": "cad" (Table V, default) or "identified" (Tables II and III of that side).
            For "cuhk": "nominal", an anthropometric plant, as the document's Table III is not a physical leg.
        base: See :func:`load_exo`; the other leg counts as part of the torso.

    Returns:
        The leg, with cumulative J for "bleex" and J of single segments for "cuhk", as in the documents.

    Raises:
        ExoidError: There is no leg, side, inertia set or base of that name.

    Example:
        >>> load_leg("bleex", side="right", inertias="identified").joint_names
        ('right_hip', 'right_knee', 'right_ankle')
    """
    urdf = _urdf(name, inertias)
    if side not in ("left", "right"):
        raise BadArgumentError(f"no side {side!r}", remedy="use 'left' or 'right'")
    joints = tuple(f"{side}_{segment}" for segment in SEGMENTS[name])
    return Leg.from_urdf(urdf, joints, cumulative=name == "bleex", base=base)


def load_exo(
    name: str,
    inertias: str | None = None,
    *,
    base: Base = "fixed",
    contacts: Mapping[str, Contact | float | Sequence[float]] | None = None,
) -> Leg:
    """Load a built-in exoskeleton: torso and both legs in one tree.

    Parameters have the documented names of each leg: ``X1_left``, ``Y1_left``, … A floating torso adds M, X0, Y0, J0.
    Mass, place and size of the torso are assumptions: no document gives them (docs/legs.md).

    Args:
        name: Name: "bleex" or "cuhk".
        inertias: Inertia set, see :func:`load_leg`.
        base: "fixed" for a torso that stands, or moves within the plane as a recording says; "moving" for the numerical
            parameters of a torso that moves in space; "floating" for rows of force and moment on the torso, before
            those of the joints.
        contacts: Kinds of contacts, see :meth:`exoid.Leg.from_urdf`.

    Returns:
        The leg of both sides, left joints first.

    Raises:
        ExoidError: There is no exoskeleton, inertia set, base or contact of that name.

    Example:
        >>> exo = load_exo("cuhk", base="floating")
        >>> exo.parameter_names[:7]
        ('M', 'X0', 'Y0', 'J0', 'X1_left', 'Y1_left', 'J1_left')
        >>> exo.row_names[:4]
        ('base_forward', 'base_up', 'base_pitch', 'left_hip')
    """
    joints = tuple(f"{side}_{segment}" for side in ("left", "right") for segment in SEGMENTS.get(name, ()))
    return Leg.from_urdf(_urdf(name, inertias), joints, cumulative=name == "bleex", base=base, contacts=contacts)


def _urdf(name: str, inertias: str | None) -> Path:
    """Path of the URDF of a built-in leg."""
    if name not in SEGMENTS:
        remedy = f"use one of {', '.join(SEGMENTS)}, or Leg.from_urdf"
        raise BadArgumentError(f"no built-in leg {name!r}", remedy=remedy)
    sets = [known for leg, known in URDFS if leg == name]
    inertias = sets[0] if inertias is None else inertias
    if inertias not in sets:
        raise BadArgumentError(f"no inertias {inertias!r} for {name!r}", remedy=f"use one of {', '.join(sets)}")
    return urdf_folder() / URDFS[name, inertias]
