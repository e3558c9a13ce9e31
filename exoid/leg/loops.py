"""Loops of a machine as they are described: which frames coincide, and which joints follow from that."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError, in_file
from exoid.tools.toml import read_toml

LoopKind = Literal["pin", "ball", "weld"]
"""What coincides at a loop: an axis, a point, or all of two frames."""

EXAMPLE = (
    'dependent = ["coupler", "rocker"], and for each loop a table [[loop]] with kind = "pin", axis = [0, 1, 0], '
    'first = {link = "coupler", xyz = [0, 0, -0.3]} and second = {link = "shank", xyz = [0.04, 0, 0.02]}'
)

ARM = 0.1
"""Distance of the points that hold the directions of a pin or weld [m]: a gap of 1 mrad counts as 0.1 mm."""


class LoopEnd(NamedTuple):
    """Frame on a link, with the placement that ``<origin>`` of a URDF has."""

    link: str  # name of the link in the URDF
    xyz: tuple[float, ...] = (0.0, 0.0, 0.0)  # origin in the axes of the link [m], (3,)
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)  # roll, pitch and yaw [rad], (3,)

    @property
    def placement(self) -> pin.SE3:
        """Placement in the axes of the link."""
        return pin.SE3(pin.rpy.rpyToMatrix(*self.rpy), np.array(self.xyz))


class Loop(NamedTuple):
    """Two frames that a joint without coordinate of its own keeps together."""

    name: str  # name in messages
    kind: LoopKind
    first: LoopEnd
    second: LoopEnd
    axis: tuple[float, ...] = (0.0, 1.0, 0.0)  # axis of a pin in both frames, (3,)

    @property
    def points(self) -> FloatArray:
        """Points of both frames that coincide [m]: one of a ball, two on the axis of a pin, three of a weld, (k, 3)."""
        along = np.array(self.axis) / math.hypot(*self.axis)
        arms = {"ball": np.zeros((0, 3)), "pin": along[None], "weld": np.eye(3)[:2]}[self.kind]
        return np.array([np.zeros(3), *(ARM * arms)])


@dataclass(frozen=True)
class Loops:
    """All loops of a machine.

    Attributes:
        loops: The loops.
        dependent: Joints of the URDF whose angles follow from those of the others.
        start: Joint angles [rad or m] near which the loops close, zero if not given: they choose the assembly.
    """

    loops: tuple[Loop, ...]
    dependent: tuple[str, ...]
    start: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def read(cls, path: str | Path) -> Loops:
        """Read a file of loops."""
        with in_file(str(path)):
            return cls.from_data(read_toml(Path(path), EXAMPLE))

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Loops:
        """Check and convert what a TOML file, an estimate or a sidecar holds."""
        _refuse_unknown(data, ("dependent", "loop", "start"), "the file")
        dependent, start, loops = data.get("dependent"), data.get("start", {}), data.get("loop")
        if not _is_list(dependent, str) or not dependent or len(set(dependent)) < len(dependent):
            raise _wrong("dependent must list each joint once that the loops solve for")
        if not isinstance(start, dict) or not _are_numbers(list(start.values())):
            raise _wrong("[start] must hold a number for each joint")
        if not _is_list(loops, dict) or not loops:
            raise _wrong("there is no [[loop]]")
        return cls(tuple(_loop(one, k) for k, one in enumerate(loops, start=1)), tuple(dependent), start)

    def to_data(self) -> dict[str, Any]:
        """Convert to what :meth:`from_data` reads."""
        loops = [
            {"name": one.name, "kind": one.kind, "axis": list(one.axis)}
            | {role: {k: x if k == "link" else list(x) for k, x in end._asdict().items()} for role, end in _ends(one)}
            for one in self.loops
        ]
        return {"dependent": list(self.dependent), "start": dict(self.start), "loop": loops}


def _ends(loop: Loop) -> tuple[tuple[str, LoopEnd], ...]:
    return ("first", loop.first), ("second", loop.second)


def _loop(data: Mapping[str, Any], number: int) -> Loop:
    name = data.get("name", f"loop {number}")
    if not isinstance(name, str):
        raise _wrong(f"the name of loop {number} is {name!r}")
    _refuse_unknown(data, ("name", "kind", "axis", "first", "second"), name)
    kind, axis = data.get("kind", ""), data.get("axis", [0.0, 1.0, 0.0])
    if kind not in get_args(LoopKind):
        raise _wrong(f"{name} has the kind {kind!r}, which is none of {', '.join(get_args(LoopKind))}")
    if not _are_numbers(axis, 3) or not math.hypot(*axis) > 0.0:
        raise _wrong(f"the axis of {name} is {axis!r}, not three numbers")
    ends: list[LoopEnd] = []
    for role in ("first", "second"):
        end = data.get(role)
        if not isinstance(end, dict) or not isinstance(end.get("link"), str):
            raise _wrong(f"{name} has no {role} = {{link = …, xyz = […]}}")
        _refuse_unknown(end, LoopEnd._fields, f"{role} of {name}")
        for key in ("xyz", "rpy"):
            if not _are_numbers(end.get(key, [0, 0, 0]), 3):
                raise _wrong(f"{key} of {name}, {role}, is {end[key]!r}, not three numbers")
        ends.append(LoopEnd(end["link"], *(tuple(map(float, end.get(key, [0, 0, 0]))) for key in ("xyz", "rpy"))))
    return Loop(name, kind, ends[0], ends[1], tuple(map(float, axis)))


def _refuse_unknown(data: Mapping[str, Any], known: Sequence[str], place: str) -> None:
    if unknown := [key for key in data if key not in known]:
        raise _wrong(f"{place} has the key {unknown[0]!r}, which is none of {', '.join(known)}")


def _is_list(values: object, kind: type) -> bool:
    return isinstance(values, list) and all(isinstance(x, kind) for x in values)


def _are_numbers(values: object, count: int | None = None) -> bool:
    """Whether values are a list of finite numbers of plausible size."""
    return (
        isinstance(values, list)
        and count in (None, len(values))
        and all(isinstance(x, (int, float)) and not isinstance(x, bool) and abs(x) < 1e6 for x in values)
    )


def _wrong(what: str) -> UnreadableInputError:
    return UnreadableInputError(what, remedy=f"write {EXAMPLE}")
