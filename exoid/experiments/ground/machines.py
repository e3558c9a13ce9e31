"""BLEEX and CUHK-EXO on the ground, with assumed friction and rotors."""

from __future__ import annotations

from exoid.errors import BadArgumentError
from exoid.leg.catalog import load_exo
from exoid.leg.leg import Leg
from exoid.rig.ground import GroundPlant
from exoid.rig.ground.plant import BLEEX_SOLES, CUHK_SOLES

RESISTANCES = {"c0": (2.0, 1.5, 0.5), "d": (0.3, 0.2, 0.1), "Ia": (0.1, 0.1, 0.03)}
"""Coulomb friction [N·m], viscous friction [N·m·s/rad] and rotors [kg·m²] of hip, knee and ankle, an assumption."""

LEGS = {"both": ("left", "right"), "left": ("left",), "right": ("right",)}


def bleex_machine(legs: str = "both", *, ground_friction: float = 0.8) -> GroundPlant:
    """Make BLEEX on the ground.

    Args:
        legs: "both", or "left" or "right" for one leg; the other one then hangs on the torso without moving.
        ground_friction: Coefficient of friction of the ground. At 0.022 a foot of
            :func:`exoid.experiments.ground.squats_and_shifts` slips for about 5 % of the time.

    Returns:
        The machine, with the friction and rotors :data:`RESISTANCES` and the soles of the URDF's drawing.

    Raises:
        ExoidError: There are no such legs.
    """
    if legs not in LEGS:
        raise BadArgumentError(f"legs {legs!r}", remedy=f"use one of {', '.join(LEGS)}")
    machine = load_exo("bleex", base="floating")
    sides = LEGS[legs]
    if len(sides) == 1:
        joints = [joint for joint in machine.joint_names if joint.startswith(sides[0])]
        machine = Leg.from_description(machine.description, joints, base="floating")
    values = {
        f"{symbol}_{label}": each[k % len(each)]
        for symbol, each in RESISTANCES.items()
        for k, label in enumerate(machine.joint_labels)
    }
    soles = {foot: sole for foot, sole in BLEEX_SOLES.items() if foot.startswith(sides)}
    return GroundPlant.build(machine, soles, values, ground_friction=ground_friction)


def cuhk_machine() -> GroundPlant:
    """Make CUHK-EXO on the ground, on point feet at the ends of its shanks.

    Returns:
        The machine, with the friction of document 2's table and the rotors of its drives (docs/legs.md).
    """
    machine = load_exo("cuhk", base="floating")
    resistances = {"c0": (1.445, 0.593), "d": (0.038, 0.192), "Ia": (0.8, 0.8), "b1": (0.0, 0.5)}
    values = {
        f"{symbol}_{label}": each[k % 2]
        for symbol, each in resistances.items()
        for k, label in enumerate(machine.joint_labels)
    }
    return GroundPlant.build(machine, CUHK_SOLES, values)
