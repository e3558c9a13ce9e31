"""Writing an estimate back into the user's URDF: inertias and friction."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exoid._typing import FloatArray
from exoid.leg.lift import Lift, lift
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.lumping import MASS_FACTOR, MassChange, distribute_bodies, refuse_mass_changes
from exoid.leg.rewriting import read_inertials, rewrite
from exoid.regression.least_squares import scaled_inverse
from exoid.tools.files import refuse_content, refuse_unwritable, write_whole
from exoid.tools.json_values import named
from exoid.tools.tables import make_table, to_text
from exoid.torques import Coulomb, Term, TorqueModel, Viscous

from .data import EstimateData

PLACES: dict[tuple[type[Term], str], str] = {(Coulomb, "c0"): "friction", (Viscous, "d"): "damping"}
"""Attribute of ``<dynamics>`` for a symbol of a type of term; another type may mean another thing by it."""


@dataclass(frozen=True, eq=False, repr=False)
class Export:
    """File that an export wrote; prints itself.

    Attributes:
        urdf: The URDF.
        estimate: Estimate that was exported.
        lift: The links, and by how much the estimate had to move to be possible.
        values: All parameters as exported, (P,), in the order of ``estimate.names``. Where the rigid bodies had to
            move, the other terms move along as their correlation with these says.
        masses: Links whose inertia was written, with their masses before and after.
        not_dissipative: Friction below zero, which a URDF must not state: written as 0.
    """

    urdf: Path
    estimate: EstimateData
    lift: Lift
    values: FloatArray
    masses: tuple[MassChange, ...]
    not_dissipative: tuple[str, ...]

    @property
    def changed_links(self) -> tuple[str, ...]:
        """Links whose inertia was written."""
        return tuple(mass.link for mass in self.masses)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Parameters that the URDF has no place for, such as rotor inertias and offsets."""
        places = places_of(self.estimate.model, PLACES)
        return tuple(name for name in self.estimate.names[len(self.lift.names) :] if name not in places)

    def to_json(self) -> dict[str, Any]:
        """Describe the export as JSON data.

        Returns:
            File, values, lift, and what is not in the file as estimated.
        """
        return {
            "urdf": str(self.urdf),
            "values": named(self.estimate.names, self.values),
            "left_out": list(self.left_out),
            "raised_to_zero": list(self.not_dissipative),
            "feasible": self.lift.feasible,
            "distance": self.lift.distance,
            "masses": {mass.link: [mass.before, mass.after] for mass in self.masses},
        }

    def __repr__(self) -> str:
        """Name the file."""
        return f"Export({str(self.urdf)!r})"

    def __str__(self) -> str:
        """Print what is in the file, and by how much the estimate had to move."""
        lines = [f"{self.urdf}: inertia of {', '.join(self.changed_links)}; friction and damping where identified"]
        if self.left_out:
            lines.append(f"note: a URDF has no place for {', '.join(self.left_out)}: left out")
        lines += [f"note: {regrouped} (also in the URDF)" for regrouped in self.estimate.regrouped]
        if rotors := [one.name for one in self.estimate.regrouped if one.name.startswith("Ia_")]:
            known = ", ".join(f'"{name}": …' for name in rotors)
            lines.append(f"note: links contain rotors; known={{{known}}} of exoid.identify takes them out of the links")
        if self.not_dissipative:
            names = ", ".join(self.not_dissipative)
            lines.append(f"note: {names} below zero would feed energy in: 0 in the URDF")
        masses = make_table(
            ("mass [kg]", "in the URDF", "exported", "factor"),
            [(m.link, f"{m.before:.4g}", f"{m.after:.4g}", f"{m.factor:.3g}") for m in self.masses],
        )
        if self.lift.feasible:
            return to_text(*lines, "the URDF has exactly the estimated parameters", masses)
        rows = [
            (name, f"{old:.5g}", f"{new:.5g}", f"{new - old:+.2g}", f"{(new - old) / std:+.2f}" if std > 0.0 else "")
            for name, old, new, std in zip(
                self.estimate.names, self.estimate.values, self.values, self.estimate.std, strict=True
            )
        ]
        moved = make_table(("parameter", "estimate", "exported", "moved", "in std"), rows)
        what = (
            "no links that can exist, with masses near the URDF's, have the estimated parameters; the nearest, with a "
            f"pull towards the URDF's links, are {self.lift.distance:.3g} std away"
        )
        return to_text(*lines, what, moved, masses)


def export_urdf(
    estimate: EstimateData, path: str | os.PathLike[str], *, pull: float = PULL, mass_factor: float = MASS_FACTOR
) -> Export:
    """Write an estimate as a URDF; see :meth:`Estimate.to_urdf`."""
    leg = estimate.model.leg
    refuse_content(path, [leg.description.sha256, *(each.sha256 for each in estimate.inputs)])
    refuse_unwritable(path)
    p = len(leg.parameter_names)
    lifted = lift(leg, estimate.values[:p], estimate.covariance[:p, :p], pull=pull, mass_factor=mass_factor)
    links = distribute_bodies(leg, lifted.link_parameters, mass_factor)
    before = read_inertials(leg.description)
    masses = tuple(MassChange(name, float(before[name][0]), float(pi[0])) for name, pi in links.items())
    refuse_mass_changes(masses, mass_factor, leg.description.name)
    values = estimate.values.copy()
    if not lifted.feasible:  # the other parameters follow, to the minimum of (β − β̂)ᵀ C⁻¹ (β − β̂)
        pull_of_bodies = scaled_inverse(estimate.covariance[:p, :p]) @ (lifted.values - values[:p])
        values[p:] += estimate.covariance[p:, :p] @ pull_of_bodies
        values[:p] = lifted.values
    dynamics: dict[str, dict[str, float]] = {}
    places, value_of = places_of(estimate.model, PLACES), dict(zip(estimate.names, values.tolist(), strict=True))
    present = {name: place for name, place in places.items() if name in value_of}
    for name, (joint, attribute) in present.items():
        dynamics.setdefault(leg.joint_names[joint], {})[attribute] = max(0.0, value_of[name])
    negative = tuple(name for name in present if value_of[name] < 0.0)
    friction = f" and <dynamics> of {', '.join(dynamics)}" if dynamics else ""
    note = (
        f"exoid: <inertial> of {', '.join(links)}{friction} are identified;\n"
        f"masses, which motion does not reveal, are nearest to {leg.description.name}; all else is as it was there."
    )
    text = rewrite(leg.description, links, dynamics, note)
    write_whole(path, [text])
    return Export(Path(path), estimate, lifted, values, masses, negative)


def places_of(model: TorqueModel, places: Mapping[tuple[type[Term], str], str]) -> dict[str, tuple[int, str]]:
    """Joint and attribute for each parameter that a file has a place for."""
    return {
        name: (block.joints[0], places[type(block.term), symbol])
        for block in model.blocks
        for symbol, name in zip(block.term.symbols, block.names, strict=True)
        if (type(block.term), symbol) in places
    }
