"""Writing an estimate as MuJoCo's own model file (MJCF): rigid bodies, rotors and friction of the joints."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.leg.closure import refuse_loops
from exoid.leg.lift import Lift
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.lumping import MASS_FACTOR, MassChange
from exoid.leg.mjcf import JointNumbers, to_mjcf
from exoid.leg.model import with_dynamic_parameters
from exoid.tools.files import refuse_content, refuse_unwritable, write_whole
from exoid.tools.tables import to_text
from exoid.torques import Armature, Coulomb, Term, Viscous

from .data import EstimateData
from .export import lift_estimate, places_of

PLACES: dict[tuple[type[Term], str], str] = {
    (Armature, "Ia"): "armature",
    (Viscous, "d"): "damping",
    (Coulomb, "c0"): "frictionloss",
}
"""Attribute of ``<joint>`` for a symbol of a type of term."""


@dataclass(frozen=True, eq=False, repr=False)
class MjcfExport:
    """File that an export to MuJoCo wrote; prints itself.

    Attributes:
        path: The file.
        estimate: Estimate that was exported.
        lift: The links, and by how much the estimate had to move to be possible.
        values: All parameters as exported, (P,), in the order of ``estimate.names``.
        masses: Links whose inertia changed, with their masses before and after.
        raised: Friction and rotor inertia below zero, which MuJoCo does not take: written as 0.
        left_out: Parameters that the file has no place for, such as the zeros of torque sensors.
    """

    path: Path
    estimate: EstimateData
    lift: Lift
    values: FloatArray
    masses: tuple[MassChange, ...]
    raised: tuple[str, ...]
    left_out: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """Describe the export as JSON data.

        Returns:
            File, values, and what is not in the file as estimated.
        """
        return {
            "mjcf": str(self.path),
            "joints": list(self.estimate.model.leg.joint_names),
            "values": dict(zip(self.estimate.names, self.values.tolist(), strict=True)),
            "raised_to_zero": list(self.raised),
            "left_out": list(self.left_out),
            "feasible": self.lift.feasible,
            "masses": {mass.link: [mass.before, mass.after] for mass in self.masses},
        }

    def __repr__(self) -> str:
        """Name the file."""
        return f"MjcfExport({str(self.path)!r})"

    def __str__(self) -> str:
        """Print what is in the file, and what is not."""
        leg = self.estimate.model.leg
        lines = [f"{self.path}: joints {', '.join(leg.joint_names)} with a motor each, on a base that does not move"]
        lines.append("armature, damping and frictionloss: identified rotor inertia, viscous and Coulomb friction")
        lines += [f"note: {regrouped} (also in the file)" for regrouped in self.estimate.regrouped]
        if self.left_out:
            lines.append(f"note: MuJoCo's joints have no place for {', '.join(self.left_out)}: left out")
        if self.raised:
            lines.append(f"note: {', '.join(self.raised)} below zero: 0 in the file")
        if not self.lift.feasible:
            lines.append(
                "note: no links that can exist have the estimated parameters; the nearest, which were written, are "
                f"{self.lift.distance:.3g} std away"
            )
        return to_text(*lines)


def export_mjcf(
    estimate: EstimateData, path: str | os.PathLike[str], *, pull: float = PULL, mass_factor: float = MASS_FACTOR
) -> MjcfExport:
    """Write an estimate as MJCF; see :meth:`Estimate.to_mjcf`."""
    leg = estimate.model.leg
    refuse_loops(leg, "an MJCF")
    if leg.base == "floating":
        raise NotSupportedError(
            "an MJCF of a floating base is not written",
            where=leg.description.name,
            remedy="write a URDF, and let MuJoCo's MjSpec add a free joint to its root",
            command="write a URDF with -o LEG.URDF",
        )
    refuse_content(path, [leg.description.sha256, *(each.sha256 for each in estimate.inputs)])
    refuse_unwritable(path)
    lifted = lift_estimate(estimate, pull, mass_factor)
    places = places_of(estimate.model, PLACES)
    found = {attribute: np.zeros(len(leg.joint_names)) for attribute in PLACES.values()}
    raised, left_out = [], []
    pairs = list(zip(estimate.names, lifted.values.tolist(), strict=True))
    for name, value in pairs[len(leg.parameter_names) :]:
        if name not in places:
            left_out.append(name)
            continue
        joint, attribute = places[name]
        found[attribute][joint] = max(0.0, value)
        if value < 0.0:
            raised.append(name)
    limits = leg.limits
    friction = found.pop("frictionloss")
    numbers = JointNumbers(**found, friction=friction, lower=limits.lower, upper=limits.upper, effort=limits.effort)
    links = tuple(leg.description.child_links[joint] for joint in leg.joint_names)
    model = with_dynamic_parameters(leg.model, lifted.lift.link_parameters)
    write_whole(path, [to_mjcf(model, links, numbers, Path(leg.description.name).stem)])
    return MjcfExport(Path(path), estimate, lifted.lift, lifted.values, lifted.masses, tuple(raised), tuple(left_out))
