"""Loops of a machine as they are described: which frames coincide, and which joints follow from that."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError, UnreadableInputError, in_file
from exoid.tools.extras import require_mujoco
from exoid.tools.files import read_bounded
from exoid.tools.json_values import json_value, record
from exoid.tools.toml import read_toml

from .description import LARGEST_NUMBER, LARGEST_URDF

LoopKind = Literal["pin", "ball", "weld"]
"""What coincides at a loop: an axis, a point, or all of two frames."""

EXAMPLE = (
    'dependent = ["coupler", "rocker"], and for each loop a table [[loops]] with name, kind = "pin", axis = [0, 1, 0], '
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
        """Read a TOML file, or an MJCF whose bodies are the links of the URDF."""
        with in_file(str(path)):
            return _of_mjcf(str(path)) if str(path).endswith(".xml") else cls.from_data(read_toml(Path(path), EXAMPLE))

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Loops:
        """Check and convert what a TOML file or an estimate holds; ``json_value`` writes it."""
        refused = partial(UnreadableInputError, remedy=f"write {EXAMPLE}")
        try:
            found = record(cls, data)
        except (TypeError, ValueError, LookupError, AttributeError) as error:
            raise refused(f"a key is missing or unknown, or has another kind of value ({error})") from None
        for loop in found.loops:
            triples = [loop.axis, *(each for end in (loop.first, loop.second) for each in (end.xyz, end.rpy))]
            finite = all(len(x) == 3 and all(abs(each) < LARGEST_NUMBER for each in x) for x in triples)
            if loop.kind not in get_args(LoopKind) or not finite or not any(loop.axis):
                kinds = ", ".join(get_args(LoopKind))
                raise refused(f"loop {loop.name} has a kind that is none of {kinds}, or numbers that no place has")
        if not found.loops or not found.dependent or not all(abs(x) < LARGEST_NUMBER for x in found.start.values()):
            raise refused("there are no [[loops]], no dependent joints, or a start that is no angle")
        return found


def _of_mjcf(path: str) -> Loops:
    """Read ``<connect>`` and ``<weld>`` of an MJCF. Joints of the loops without an actuator are dependent."""
    mujoco = require_mujoco()
    try:
        read_bounded(path, LARGEST_URDF, "give an MJCF").decode("utf-8")  # MuJoCo's names are read so, too
        model = mujoco.MjModel.from_xml_path(path)
    except ValueError as error:
        raise UnreadableInputError(f"MuJoCo cannot read it ({error})", remedy="give an MJCF, or a TOML file") from None
    kinds = {mujoco.mjtEq.mjEQ_CONNECT: "ball", mujoco.mjtEq.mjEQ_WELD: "weld"}
    loops, around = [], set[int]()
    for k in np.flatnonzero(model.eq_active0):
        about, numbers, kind = model.equality(k), model.eq_data[k], kinds.get(int(model.eq_type[k]))
        at = [int(about.obj1id[0]), int(about.obj2id[0])]
        by_site = int(model.eq_objtype[k]) == mujoco.mjtObj.mjOBJ_SITE
        if kind is None or (by_site and kind == "weld"):
            raise NotSupportedError(f"its equality {about.name!r} is no <connect>, and no <weld> of two bodies")
        places = [numbers[3:6], numbers[:3]] if kind == "weld" else [numbers[:3], numbers[3:6]]
        if by_site:
            at, places = [int(model.site_bodyid[site]) for site in at], [model.site_pos[site] for site in at]
        turn = pin.rpy.matrixToRpy(pin.Quaternion(*numbers[6:10]).matrix()) if kind == "weld" else np.zeros(3)
        names, turns = [model.body(body).name for body in at], [turn, np.zeros(3)]
        ends = [LoopEnd(*each) for each in zip(names, map(tuple, places), map(tuple, turns), strict=True)]
        loops.append({"name": about.name or f"equality {k}", "kind": kind, "first": ends[0], "second": ends[1]})
        around |= _carriers(model, at[0]) ^ _carriers(model, at[1])
    driven = model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT, 0]
    joints = [j for j in range(model.njnt) if int(model.jnt_bodyid[j]) in around and j not in driven]
    return Loops.from_data(json_value({"loops": loops, "dependent": [model.joint(j).name for j in joints]}))


def _carriers(model: Any, body: int) -> set[int]:  # noqa: ANN401 - of MuJoCo
    """Body and all bodies between it and the world."""
    return {body} | _carriers(model, int(model.body_parentid[body])) if body else set()
