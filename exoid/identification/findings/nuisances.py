"""Faults that nuisance columns describe, each a combination of some of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torques import TorqueModel

from .arm_columns import ArmColumns
from .nuisance_columns import Column

FORMS = {
    "friction |v|": ("asymmetric friction", "N·m·s/rad"),
    "friction v²": ("quadratic friction", "N·m·s²/rad²"),
    "friction Stribeck": ("Stribeck friction", "N·m"),
    "friction load": ("friction that grows with the load", "1"),
}
"""Form that each column describes, and its unit."""


class Nuisance(NamedTuple):
    """One kind of fault that columns describe."""

    kind: str  # kind of the finding
    joint: str  # name of the joint; "" for all
    place: int  # index of the joint, or of the segment; −1 for all
    unit: str  # unit of the fault
    columns: tuple[int, ...]  # indices of the columns that it combines
    group: bool = False  # whether the columns have a coefficient each; else they share one
    form: str = ""  # form of the fault, such as "Stribeck friction"; "" for any

    @property
    def combination(self) -> FloatArray:
        """Weights of its columns, one row for each, (len(columns), m)."""
        return np.eye(len(self.columns)) if self.group else np.ones((len(self.columns), 1))


def nuisances(
    model: TorqueModel, layout: Sequence[Column], arms: Mapping[int, ArmColumns] | None = None
) -> tuple[Nuisance, ...]:
    """List the faults that are tested, as combinations of nuisance columns."""
    # In a planar leg a tilt of the base changes the torque as the zero of the first angle does, so that only one of the
    # two is tested. Of the torque scales of two joints only the ratio shows, so that only the second is tested.
    names, planar = model.joint_names, model.leg.chain is not None
    places: dict[tuple[str, int], list[int]] = {}
    for k, column in enumerate(layout):
        places.setdefault((column.kind, column.place), []).append(k)
    found = []
    if len(names) > 1:
        every = tuple(places["delay", j][0] for j in range(len(names)))
        found.append(Nuisance("torque-delay", "", -1, "s", every))
    for j, joint in enumerate(names):
        found.append(Nuisance("torque-delay", joint, j, "s", tuple(places["delay", j])))
        if len(names) != 2 or j == 1:  # of two joints only the ratio shows
            found.append(Nuisance("torque-scale", joint, j, "1", tuple(places["gain", j])))
        found.append(Nuisance("angle-scale", joint, j, "1", tuple(places["scale", j])))
        tilts = planar and j == 0
        zero = tuple(places["zero", j])
        found.append(Nuisance("gravity-direction" if tilts else "angle-offset", "" if tilts else joint, j, "rad", zero))
        if ("length", j) in places:
            found.append(Nuisance("segment-length", joint, j, "1", tuple(places["length", j])))
        for kind, (form, unit) in FORMS.items():
            found.append(Nuisance("unmodelled-friction", joint, j, unit, tuple(places[kind, j]), form=form))
        force = (*places["force", j], *places["force²", j])
        found.append(Nuisance("unmodelled-force", joint, j, "N·m", force, group=True))
        if arms is not None and j in arms:
            arm = tuple(places["arm", j])
            found.append(Nuisance("moment-arm", joint, j, arms[j].unit, arm, group=True, form=arms[j].what))
        if ("cross-talk", j) in places:
            found.append(Nuisance("cross-talk", joint, j, "1", tuple(places["cross-talk", j]), group=True))
    if ("clock", 0) in places:
        found.append(Nuisance("clock", "", -1, "1", tuple(places["clock", 0])))
    if not planar:
        tilt = tuple(places["gravity", k][0] for k in range(2))
        found.append(Nuisance("gravity-direction", "", -1, "rad", tilt, group=True))
    return tuple(found)


def always(layout: Sequence[Column]) -> tuple[int, ...]:
    """Nuisance columns that every test contains, so that the sharpness of friction is not taken for another fault."""
    return tuple(k for k, column in enumerate(layout) if column.kind == "sharpness")
