"""Legs on the command line: built-in ones, those of datasets, and URDF files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import exoid
from exoid.errors import BadArgumentError, nearest

from .messages import note
from .numbers import parse_contacts, split_names
from .options import LegOptions
from .refusals import is_readable, names_beside, refuse, refuse_form

if TYPE_CHECKING:
    from exoid.leg.leg import Leg
    from exoid.signals import Poses, Recording
    from exoid.signals.datasets import Dataset

BUILT_IN = ("bleex", "cuhk")

DATASETS = {
    "bleex_swing": ("bleex_swing",),
    "dfki_double_pendulum": ("dfki_double_pendulum",),
    "sydney_swing_leg": ("sydney_swing_leg",),
    "sydney_swing_leg_outer": ("sydney_swing_leg", "outer"),
    "teststand_leg": ("teststand_leg",),
}
"""Function and arguments of each dataset, as LEG ``name`` and LOG ``name:train`` or ``name:test``."""


def dataset(name: str) -> Dataset:
    """Load a dataset."""
    function, *arguments = DATASETS[name]
    found: Dataset = getattr(exoid.datasets, function)(*arguments)
    return found


def find_leg(name: str, options: LegOptions, logged: Sequence[str] | None) -> Leg:
    """Load a leg: a built-in one, that of a dataset, or of a URDF file."""
    side, inertias, joints, moving, floating, contact, loops = options
    base: Literal["fixed", "moving", "floating"] = "moving" if moving else "floating" if floating else "fixed"
    if name in BUILT_IN or name in DATASETS:
        refuse({"--moving-base": moving or None}, f"{name} is planar; name a URDF file for a base in space")
        refuse({"--joints": joints, "--loops": loops}, f"joints of {name} are known")
    kinds = parse_contacts(contact)
    if name in BUILT_IN:
        if side == "both" or (floating and side is None):
            return exoid.load_exo(name, inertias, base=base, contacts=kinds)
        refuse({"--contact": contact}, "--contact is for --floating-base, of both sides")
        return exoid.load_leg(name, side or _side(logged or ()), inertias, base=base)
    refuse({"--side": side, "--inertias": inertias}, f"{name!r} is no built-in leg")
    if name in DATASETS:
        refuse({"--floating-base": floating or None, "--contact": contact}, f"the base of {name} was held")
        return dataset(name).leg
    refuse_unknown_leg(name)
    if moving:
        refuse({"--floating-base": floating or None}, "--moving-base is for rows of joints only")
    chosen = split_names(joints)
    if chosen is None and logged is not None:
        from exoid.leg.loops import Loops  # noqa: PLC0415 - help needs no legs

        chosen = _moving_joints(Path(name), logged, () if loops is None else Loops.read(loops).dependent)
    return exoid.Leg.from_urdf(name, chosen, base=base, contacts=kinds, loops=loops)


def refuse_unknown_leg(name: str) -> None:
    """Refuse what is neither a leg nor a file, before logs are read whose columns would be blamed."""
    if is_readable(name):
        refuse_form(name, "LEG")
        return
    if name in BUILT_IN or name in DATASETS:
        return
    if os.path.isdir(name):  # noqa: PTH112 - as in is_readable
        raise BadArgumentError("is a folder, not a URDF file", where=name, remedy="name the URDF file in it")
    known = ", ".join([*BUILT_IN, *DATASETS])
    similar = nearest(Path(name).name, [*BUILT_IN, *DATASETS, *names_beside(name)])
    remedy = f"{similar}name a built-in leg ({known}), or a URDF file"
    raise BadArgumentError(f"no leg or URDF file {name!r}", remedy=remedy)


def _side(logged: Sequence[str]) -> str:
    """Side of the logged joints; left if their names have none."""
    sides = [side for side in ("left", "right") if any(joint.startswith(f"{side}_") for joint in logged)]
    if len(sides) > 1:
        remedy = "choose with --side left, --side right or --side both"
        raise BadArgumentError("the log has joints of both sides", remedy=remedy)
    return sides[0] if sides else "left"


def _moving_joints(urdf: Path, logged: Sequence[str], followed: Sequence[str]) -> tuple[str, ...]:
    """Logged joints of a URDF, from the base outwards, without those that follow from loops."""
    joints = tuple(joint for joint in _joint_order(urdf) if joint not in followed)
    if not joints:
        remedy = "give joints a type such as revolute"
        raise BadArgumentError("no joint of the URDF moves", where=str(urdf), remedy=remedy)
    moving = tuple(joint for joint in joints if joint in logged)
    if not moving:
        raise BadArgumentError(
            f"none of the logged joints ({', '.join(logged)}) is in the URDF ({', '.join(joints)})",
            where=str(urdf),
            remedy=f"map the log's columns, e.g. --column q_{joints[0]}=HEADER --column tau_{joints[0]}=HEADER",
        )
    if held := [joint for joint in joints if joint not in moving]:
        _refuse_followers(urdf, held, moving)
        note(f"not in the log, and held at zero: {', '.join(held[:6])}{', …' if len(held) > 6 else ''}")
    return moving


def _refuse_followers(urdf: Path, held: Sequence[str], moving: Sequence[str]) -> None:
    """Refuse to hold a joint that follows one of the log by a gear or a rod (<mimic>): it moves, too."""
    from exoid.leg.description import read_description  # noqa: PLC0415 - help needs no legs

    every = read_description(urdf).parse().iterfind("joint")
    for name, leader in ((joint.get("name"), one.get("joint")) for joint in every for one in joint.iterfind("mimic")):
        if name in held and leader in moving:
            what = f"{name} follows {leader} in the URDF (<mimic>), which exoid does not read, and is not in the log"
            remedy = "describe what couples them as a loop (--loops); if it hardly moves, hold it: --joints "
            raise BadArgumentError(what, where=str(urdf), remedy=remedy + ",".join(moving))


def refuse_without_base(options: LegOptions, recordings: Sequence[Recording | Poses]) -> None:
    """Refuse the rows of a base whose motion, or whose support, no recording has."""
    what, parts = "--moving-base, but no log has the motion of the base", ("base", "torso")
    columns = "columns are base_gyro_x to _z and base_acc_x to _z, or base_x to _z and base_qw to _qz"
    if options.floating_base:
        what = "--floating-base, but no log says what the leg stands on or hangs from"
        columns, parts = "columns are contact_<foot> (0 or 1) or wrench_<link>_fx to _mz", ("contacts", "wrenches")
    logs = (each for each in recordings if isinstance(each, exoid.Recording))  # one is in memory at a time
    asked = options.moving_base or options.floating_base
    if asked and not any(getattr(each, part) for each in logs for part in parts):
        raise BadArgumentError(what, remedy=f"its {columns}; or leave it out")


def _joint_order(urdf: Path) -> tuple[str, ...]:
    """All joints of a URDF in Pinocchio's order, without the reduction, which takes seconds for a humanoid."""
    import pinocchio as pin  # noqa: PLC0415 - help needs no legs

    from exoid.leg.description import read_description  # noqa: PLC0415

    try:
        return tuple(pin.buildModelFromXML(read_description(urdf).text).names)[1:]
    except Exception:  # any error of Pinocchio's parser: the leg has a better message
        return exoid.Leg.from_urdf(urdf).joint_names
