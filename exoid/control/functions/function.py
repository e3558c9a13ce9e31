"""A function as data: contacts in order, trajectories over its phase, conditions of entry and exit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import ComplexArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked

from .body import SIDES, Body

PHASE = np.linspace(0.0, 1.0, 201)
"""Phases at which trajectories are tabulated."""

Contacts = frozenset[str]


@dataclass(frozen=True, eq=False, repr=False)
class Function:
    """One function of an exoskeleton as data, tabulated over :data:`PHASE`.

    Attributes:
        name: Name.
        duration: Time from phase 0 to 1 [s].
        flexion: Flexion of hip, knee and ankle of left and right leg [rad], (K, 2, 3).
        torso: Hip forward and up from the ground under the start [m], and pitch [rad], (K, 3).
        contacts: Sets of contacts in order, each with the phase at which it begins.
        cyclic: Whether phase 1 is followed by phase 0.
        room: Distance from the first or last posture within which it may begin or end [rad], an assumption.

    Raises:
        ExoidError: The duration is not positive or above a minute, a table is not over PHASE, or contacts not in order.
    """

    name: str
    duration: float
    flexion: FloatArray
    torso: FloatArray
    contacts: tuple[tuple[float, Contacts], ...]
    cyclic: bool = False
    room: float = 0.5

    def __post_init__(self) -> None:
        """Check the duration, the tables and the contacts."""
        checked(self.duration, f"the duration of {self.name} [s]", above=0.0, most=60.0)
        starts, rows = [start for start, _ in self.contacts], len(PHASE)
        shapes = self.flexion.shape == (rows, 2, 3) and self.torso.shape == (rows, 3)
        if not shapes or not np.isfinite(self.flexion).all() or starts != sorted({0.0, *starts}):
            raise BadArgumentError(
                f"{self.name}: flexion {self.flexion.shape}, torso {self.torso.shape}, contacts from {starts}",
                remedy=f"give finite angles at {rows} phases, and contacts in order from phase 0",
            )

    def expected(self, phase: float) -> Contacts:
        """Look up the contacts that the function expects.

        Args:
            phase: Phase; of a cyclic function any number.

        Returns:
            Feet and seat that bear load.
        """
        p = phase % 1.0 if self.cyclic else min(max(phase, 0.0), 1.0)
        return [contacts for start, contacts in self.contacts if start <= p + 1e-9][-1]

    def __repr__(self) -> str:
        """Name the function, its duration and its contacts."""
        order = ", ".join("+".join(sorted(each)) or "air" for _, each in self.contacts)
        return f"Function({self.name}: {self.duration:g} s{', cyclic' if self.cyclic else ''}; {order})"


def placed(
    name: str,
    body: Body,
    duration: float,
    hip: ComplexArray,
    pitch: FloatArray,
    order: tuple[tuple[float, Contacts], ...],
    *,
    feet: Mapping[str, ComplexArray] | None = None,
    tilt: Mapping[str, FloatArray] | None = None,
    cyclic: bool = False,
) -> Function:
    """Function whose soles are at given places or at the origin, and level or tilted."""
    origin = dict.fromkeys(SIDES, np.zeros(len(PHASE), dtype=np.complex128))
    places, turn = feet or origin, tilt or dict.fromkeys(SIDES, np.zeros(len(PHASE)))
    flexion = np.stack([body.reach(hip, pitch, places[side], turn[side]) for side in SIDES], axis=1)
    if body.ankle == 0.0:
        flexion[..., 2] = 0.0
    return Function(name, duration, flexion, np.column_stack([hip.real, hip.imag, pitch]), order, cyclic)
