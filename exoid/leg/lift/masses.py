"""Masses of links beside those of the URDF, which motion hardly reveals and an export must not change beyond belief."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.leg.description import Description
from exoid.leg.rewriting import read_inertials

MASS_FACTOR = 5.0
"""Usual limit of the mass of a link over its mass in the URDF, and of the inverse.

A leg with its wearer weighs up to five times as much as the exoskeleton alone. Links of noisy estimates stay within a
factor of 3 where the pull towards the URDF's own links is the usual one.
"""


class MassChange(NamedTuple):
    """Mass of a link, before and after."""

    link: str  # name of the link
    before: float  # mass in the URDF [kg]
    after: float  # new mass [kg]

    @property
    def factor(self) -> float:
        """New mass over that in the URDF."""
        return self.after / self.before

    @property
    def change(self) -> float:
        """Factor of the change, at least 1 whether the link became heavier or lighter."""
        return max(self.factor, 1.0 / self.factor)


def mass_changes(description: Description, links: Mapping[str, FloatArray]) -> tuple[MassChange, ...]:
    """Compare masses of links with those in a URDF."""
    before = read_inertials(description)
    return tuple(MassChange(name, float(before[name][0]), float(pi[0])) for name, pi in links.items())


def refuse_mass_changes(masses: Sequence[MassChange], mass_factor: float, name: str) -> None:
    """Refuse links whose masses are far from those in the URDF."""
    beyond = [mass for mass in masses if not mass.change <= mass_factor]
    if not beyond:
        return
    what = ", ".join(f"{m.link} would weigh {m.after:.3g} kg instead of {m.before:.3g} kg" for m in beyond)
    allowed = f"{math.ceil(1.01 * max(mass.change for mass in beyond))}"
    raise NotIdentifiableError(
        f"{what}: beyond a factor of {mass_factor:g}",
        where=name,
        remedy="correct the masses in the URDF, identify with prior=Prior.from_leg(leg) or from a better motion, or "
        f"allow it by mass_factor={allowed} (--mass-factor {allowed})",
    )
