"""Constants of a planar leg as tables in C."""

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


def constants_of_bodies(leg: Leg, known: Mapping[str, float], dialect: Dialect) -> Iterator[Constants]:
    """Write directions, distances and the parameters X, Y and J of a planar leg."""
    if leg.chain is None:
        return
    joints, number = leg.joint_names, dialect.number
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
