"""Legs on the command line: built-in ones, those of datasets, URDF files and robots by name."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from functools import partial
from pathlib import Path

import pinocchio as pin

from exoid.errors import ExoidError
from exoid.leg.catalog import SEGMENTS, load_exo, load_leg
from exoid.leg.description import read_description
from exoid.leg.leg import Leg
from exoid.leg.leg_data import Base
from exoid.signals import datasets

from .refusals import is_readable, refuse
from .robots import how_to_name_one, is_robot, urdf_of_robot

DATASETS: Mapping[str, Callable[[], datasets.Dataset]] = {
    "bleex_swing": datasets.bleex_swing,
    "dfki_double_pendulum": datasets.dfki_double_pendulum,
    "sydney_swing_leg": datasets.sydney_swing_leg,
    "sydney_swing_leg_outer": partial(datasets.sydney_swing_leg, "outer"),
    "teststand_leg": datasets.teststand_leg,
}
"""Datasets of exoid, as LEG ``name`` and LOG ``name:train`` or ``name:test``."""


def find_leg(
    name: str,
    side: str | None,
    inertias: str | None,
    joints: Sequence[str] | None,
    logged: Sequence[str] | None,
    *,
    moving_base: bool = False,
    floating_base: bool = False,
) -> Leg:
    """Load a leg: a built-in one, that of a dataset, of a URDF file, or a robot of example-robot-data."""
    if name in SEGMENTS or name in DATASETS:
        refuse({"--moving-base": moving_base or None}, f"{name} is planar; name a URDF file for a base in space")
    if name in SEGMENTS:
        refuse({"--joints": joints}, f"the joints of {name} are known")
        base: Base = "floating" if floating_base else "fixed"
        if side == "both" or (floating_base and side is None):
            return load_exo(name, inertias, base=base)
        return load_leg(name, side or _side(logged or ()), inertias, base=base)
    refuse({"--side": side, "--inertias": inertias}, f"{name!r} is no built-in leg")
    if name in DATASETS:
        refuse({"--joints": joints}, f"the joints of {name} are known")
        refuse({"--floating-base": floating_base or None}, f"the base of {name} was held")
        return DATASETS[name]().leg
    refuse_unknown_leg(name)
    if not is_readable(name):
        name = str(urdf_of_robot(name))
    if joints is None and logged is not None:
        joints = _moving_joints(Path(name), logged)
    if moving_base:
        refuse({"--floating-base": floating_base or None}, "--moving-base is for rows of joints only")
        return Leg.from_urdf(name, joints, base="moving")
    return Leg.from_urdf(name, joints, base="floating" if floating_base else "fixed")


def refuse_unknown_leg(name: str) -> None:
    """Refuse what is neither a leg nor a file, before logs are read whose columns would be blamed."""
    if name in SEGMENTS or name in DATASETS or is_readable(name) or is_robot(name):
        return
    if os.path.isdir(name):  # noqa: PTH112 - as in is_readable
        raise ExoidError("is a folder, not a URDF file", where=name, remedy="name the URDF file in it")
    known = ", ".join([*SEGMENTS, *DATASETS])
    similar = get_close_matches(Path(name).name, _names_beside(Path(name)), n=3, cutoff=0.6)
    beside = f"; there is {', '.join(similar)}" if similar else ""
    remedy = f"name a built-in leg ({known}), a URDF file, or {how_to_name_one()}"
    raise ExoidError(f"no leg or URDF file {name!r}{beside}", remedy=remedy)


def _names_beside(path: Path) -> list[str]:
    try:
        return [each.name for each in path.parent.iterdir()]
    except (OSError, ValueError):
        return []


def _side(logged: Sequence[str]) -> str:
    """Side of the logged joints; left if their names have none."""
    sides = [side for side in ("left", "right") if any(joint.startswith(f"{side}_") for joint in logged)]
    if len(sides) > 1:
        raise ExoidError(
            "the log has joints of both sides", remedy="choose with --side left, --side right or --side both"
        )
    return sides[0] if sides else "left"


def _moving_joints(urdf: Path, logged: Sequence[str]) -> tuple[str, ...]:
    """Logged joints of a URDF, from the base outwards."""
    joints = _joint_order(urdf)
    if not joints:
        raise ExoidError("no joint of the URDF moves", where=str(urdf), remedy="give joints a type such as revolute")
    moving = tuple(joint for joint in joints if joint in logged)
    if not moving:
        raise ExoidError(
            f"none of the logged joints ({', '.join(logged)}) is in the URDF ({', '.join(joints)})",
            where=str(urdf),
            remedy=f"map the log's columns, e.g. --column q_{joints[0]}=HEADER --column tau_{joints[0]}=HEADER",
        )
    return moving


def _joint_order(urdf: Path) -> tuple[str, ...]:
    """All joints of a URDF in Pinocchio's order, without the reduction, which takes seconds for a humanoid."""
    try:
        return tuple(pin.buildModelFromXML(read_description(urdf).text).names)[1:]
    except Exception:  # any error of Pinocchio's parser: the leg has a better message
        return Leg.from_urdf(urdf).joint_names
