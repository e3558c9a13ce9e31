"""Rotors that a turning base tells from the links that they turn with."""

from __future__ import annotations

from collections.abc import Iterable

from exoid.torques import TorqueModel
from exoid.torques.regrouping import regroup


def rotors_apart(models: Iterable[TorqueModel]) -> tuple[str, ...]:
    """Name parameters that a fixed base regroups into others, and a turning base does not."""
    # On a fixed base a rotor at the hip turns with the whole leg, and J1 includes it. Where the torso pitches by ψ, the
    # leg has the acceleration q̈ + ψ̈ and the rotor q̈.
    found: dict[str, None] = {}
    for model in models:
        merged = {one.name for one in model.regrouped}
        still = {one.name for one in regroup(model.leg, model.blocks, model.rigid, moving_base=True)}
        found |= dict.fromkeys(one.name for one in model.regrouped if one.name in merged - still)
    return tuple(found)
