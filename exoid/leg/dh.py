"""Denavit-Hartenberg tables as URDFs, for robots that come without one.

The transform of row i is, with θ = q + offset,

* standard (Denavit and Hartenberg 1955): Rz(θ) Tz(d) Tx(a) Rx(α), and joint i turns about z of frame i − 1;
* modified (Craig 1986): Rx(α) Tx(a) Rz(θ) Tz(d), and joint i turns about z of frame i.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape  # xml.sax.saxutils would load urllib and ssl
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked

from .description import FARTHEST, LARGEST_ANGLE, Description, describe

Convention = Literal["standard", "modified"]


class DHRow(NamedTuple):
    """One row of a Denavit-Hartenberg table, of a revolute joint."""

    a: float  # length of the common normal [m]
    alpha: float  # twist about it [rad]
    d: float  # offset along the joint axis [m]
    offset: float = 0.0  # joint angle θ of the table at q = 0 [rad]


def describe_dh(
    table: Sequence[DHRow] | ArrayLike,
    convention: Convention,
    joint_names: Sequence[str] | None = None,
    *,
    base_rpy: Sequence[float] = (0.0, 0.0, 0.0),
    name: str = "dh",
) -> Description:
    """Write the URDF of a Denavit-Hartenberg table."""
    if convention not in ("standard", "modified"):
        raise BadArgumentError(
            f"no DH convention {convention!r}",
            where=name,
            remedy='pass "standard" (Rz Tz Tx Rx) or "modified" (Rx Tx Rz Tz, Craig)',
        )
    rows = _rows(table, name)
    joints = tuple(f"joint{k}" for k in range(1, len(rows) + 1)) if joint_names is None else tuple(joint_names)
    if isinstance(joint_names, str) or len(joints) != len(rows) or len(set(joints)) != len(rows):
        raise BadArgumentError(
            f"{len(rows)} rows, and joint_names {joint_names!r}", where=name, remedy="name each joint of the table once"
        )
    rpy = checked(base_rpy, "base_rpy")
    if rpy.shape != (3,):
        raise BadArgumentError(f"base_rpy has shape {rpy.shape}", where=name, remedy="give roll, pitch and yaw [rad]")
    _refuse_degrees(rpy, "base_rpy", name)
    placement = _joint("base_to_frame0", "fixed", "base", "frame0", (0.0, 0.0, 0.0), rpy.tolist())
    parts = [_link("base"), _link("frame0"), placement]
    for index, (row, joint) in enumerate(zip(rows, joints, strict=True), start=1):
        parts += _segment(index, DHRow(*row), str(joint), convention)
    return describe(f"<robot name={_quoted(name)}>\n" + "\n".join(parts) + "\n</robot>\n", name)


def _quoted(text: str) -> str:
    """Write an attribute of XML."""
    return f'"{escape(text)}"'


def _segment(index: int, row: DHRow, joint: str, convention: Convention) -> list[str]:
    """Link and joints of a row: what turns, and the fixed frame before or behind it."""
    link, before, after = f"{joint}_link", f"frame{index - 1}", f"frame{index}"
    twist, turn = (row.alpha, 0.0, 0.0), (0.0, 0.0, row.offset)
    if convention == "standard":
        return [
            _link(link, _inertial((row.a, 0.0, row.d), row.alpha)),
            _joint(joint, "continuous", before, link, (0.0, 0.0, 0.0), turn),
            _link(after),
            _joint(f"{link}_to_{after}", "fixed", link, after, (row.a, 0.0, row.d), twist),
        ]
    pivot = f"pivot{index}"
    return [
        _link(pivot),
        _joint(f"{before}_to_{pivot}", "fixed", before, pivot, (row.a, 0.0, 0.0), twist),
        _link(link, _inertial((0.0, 0.0, 0.0), 0.0)),
        _joint(joint, "continuous", pivot, link, (0.0, 0.0, row.d), turn),
        _link(after),
        _joint(f"{link}_to_{after}", "fixed", link, after, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    ]


def _rows(table: Sequence[DHRow] | ArrayLike, name: str) -> FloatArray:
    """Check the table, (n, 4)."""
    rows = checked(table, "the DH table", ndim=2)
    if rows.ndim != 2 or not len(rows) or rows.shape[1] not in (3, 4):
        raise BadArgumentError(
            f"a DH table of shape {rows.shape}",
            where=name,
            remedy="give rows (a, alpha, d, offset), one for each joint",
        )
    rows = np.column_stack([rows, np.zeros((len(rows), 4 - rows.shape[1]))])
    if np.abs(rows[:, [0, 2]]).max() > FARTHEST:
        raise BadArgumentError(
            f"a length of {np.abs(rows[:, [0, 2]]).max():g} m looks like millimetres", where=name, remedy="give m"
        )
    _refuse_degrees(rows[:, [1, 3]], "the DH table", name)
    return rows


def _refuse_degrees(angles: FloatArray, what: str, name: str) -> None:
    if np.abs(angles).max() > LARGEST_ANGLE:
        raise BadArgumentError(
            f"an angle of {np.abs(angles).max():g} rad in {what} looks like degrees",
            where=name,
            remedy="give rad, e.g. np.deg2rad(90)",
        )


def _inertial(place: tuple[float, float, float], alpha: float) -> str:
    """Unit mass of a link at the origin of its frame i, which is placed and twisted so in the link."""
    inertia = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>'
    return f'<inertial>{_origin(place, (alpha, 0.0, 0.0))}<mass value="1.0"/>{inertia}</inertial>'


def _link(name: str, inertial: str = "") -> str:
    return f"<link name={_quoted(name)}>{inertial}</link>"


def _joint(name: str, kind: str, parent: str, child: str, xyz: Sequence[float], rpy: Sequence[float]) -> str:
    ends = f"<parent link={_quoted(parent)}/><child link={_quoted(child)}/>"
    axis = '<axis xyz="0 0 1"/>' if kind != "fixed" else ""
    return f"<joint name={_quoted(name)} type={_quoted(kind)}>{ends}{_origin(xyz, rpy)}{axis}</joint>"


def _origin(xyz: Sequence[float], rpy: Sequence[float]) -> str:
    place, turn = (" ".join(repr(float(x)) for x in values) for values in (xyz, rpy))
    return f'<origin xyz="{place}" rpy="{turn}"/>'
