"""Constants of a leg's bodies as tables in C."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

from exoid.leg.leg import Leg

from .dialect import Dialect


class Constants(NamedTuple):
    """Table of numbers."""

    name: str  # name in C, after the prefix
    what: str  # comment above the table, with the unit
    rows: Sequence[tuple[str, str]]  # label and number of each row


def constants_of_bodies(
    leg: Leg, known: Mapping[str, float], rotor: Sequence[str], dialect: Dialect
) -> Iterator[Constants]:
    """Write rotors, if there are any, and of a planar leg directions, distances and the parameters X, Y and J."""
    joints, number = leg.joint_names, dialect.number
    if leg.chain is not None:
        signs = [(f"axis of {joint}", number(sign)) for joint, sign in zip(joints, leg.chain.signs, strict=True)]
        yield Constants("sign", "+1 where positive q turns x towards z", signs)
        ends = [*pairwise(joints), (joints[-1], "the end, not needed")]
        for axis, column in (("dx", 0), ("dz", 1)):
            reach = zip(ends, [*leg.chain.offsets[:, column], 0.0], strict=True)
            lengths = [(f"{here} to {there}", number(length)) for (here, there), length in reach]
            yield Constants(axis, f"to the next joint, along {axis[1]} at the zero pose [m]", lengths)
        for offset, (symbol, unit) in enumerate((("X", "kg m"), ("Y", "kg m"), ("J", "kg m^2"))):
            names = leg.parameter_names[offset : 3 * leg.chain.n : 3]
            yield Constants(symbol, f"[{unit}]", [(name, number(known[name])) for name in names])
    if rotor:
        rows = [(f"rotor of {joint}", inertia) for joint, inertia in zip(joints, rotor, strict=True)]
        yield Constants("rotor", "where it is a separate parameter [kg m^2]", rows)
