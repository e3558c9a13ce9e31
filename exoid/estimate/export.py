"""Writing an estimate back into the user's URDF: inertias and friction there, the rest in a file beside it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.lift import Lift, lift
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.lumping import MASS_FACTOR, MassChange, distribute_bodies, mass_changes, refuse_mass_changes
from exoid.leg.rewriting import rewrite
from exoid.regression.least_squares import scaled_inverse
from exoid.tools.files import refuse_content, refuse_unwritable, write_together
from exoid.tools.json_values import named
from exoid.tools.tables import make_table, to_text
from exoid.torques import Coulomb, Term, TorqueModel, Viscous
from exoid.torques.catalog import term_to_json

from .data import EstimateData

SCHEMA = "exoid-sidecar-2"

PLACES: dict[tuple[type[Term], str], str] = {(Coulomb, "c0"): "friction", (Viscous, "d"): "damping"}
"""Attribute of ``<dynamics>`` for a symbol of a type of term; another type may mean another thing by it."""


@dataclass(frozen=True, eq=False, repr=False)
class Export:
    """Files that an export wrote; prints itself.

    Attributes:
        urdf: The URDF.
        sidecar: The file beside it, with everything that a URDF has no place for.
        estimate: Estimate that was exported.
        lift: The links, and by how much the estimate had to move to be possible.
        values: All parameters as exported, (P,), in the order of ``estimate.names``. Where the rigid bodies had to
            move, the other terms move along as their correlation with these says.
        masses: Links whose inertia was written, with their masses before and after.
        not_dissipative: Friction below zero, which a URDF must not state: written as 0, and as it is in the sidecar.
    """

    urdf: Path
    sidecar: Path
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
    def only_in_sidecar(self) -> tuple[str, ...]:
        """Parameters that the URDF has no place for."""
        places = places_of(self.estimate.model, PLACES)
        return tuple(name for name in self.estimate.names[len(self.lift.names) :] if name not in places)

    def to_json(self) -> dict[str, Any]:
        """Describe an export as the sidecar has it.

        Returns:
            Parameters, terms and lift, as the sidecar file has them.
        """
        estimate, leg = self.estimate, self.estimate.model.leg
        terms = [term_to_json(term) for term in estimate.model.terms]
        return {
            "schema": SCHEMA,
            "urdf": self.urdf.name,
            "joints": list(leg.joint_names),
            "values": named(estimate.names, self.values),
            "units": named(estimate.names, estimate.units),
            "only_here": list(self.only_in_sidecar),
            "terms": terms,
            "term_of": _term_of(estimate.model, [term["term"] for term in terms]),
            "shapes": named(estimate.nonlinear.names, estimate.nonlinear.values),
            "merged": {regrouped.name: regrouped.into for regrouped in estimate.regrouped},
            "estimate": {"values": named(estimate.names, estimate.values), "std": named(estimate.names, estimate.std)},
            "lift": {
                "feasible": self.lift.feasible,
                "distance": self.lift.distance,
                "masses": {mass.link: [mass.before, mass.after] for mass in self.masses},
            },
        }

    def __repr__(self) -> str:
        """Name the files."""
        return f"Export({str(self.urdf)!r}, {str(self.sidecar)!r})"

    def __str__(self) -> str:
        """Print what is where, and by how much the estimate had to move."""
        lines = [f"{self.urdf}: inertia of {', '.join(self.changed_links)}; friction and damping where identified"]
        only = ", ".join(self.only_in_sidecar) or "how friction is smoothed, and where all this comes from"
        lines.append(f"{self.sidecar}: what a URDF has no place for: {only}")
        lines += [f"note: {regrouped} (also in the URDF)" for regrouped in self.estimate.regrouped]
        if rotors := [one.name for one in self.estimate.regrouped if one.name.startswith("Ia_")]:
            known = ", ".join(f'"{name}": …' for name in rotors)
            lines.append(f"note: links contain rotors; known={{{known}}} of exoid.identify takes them out of the links")
        if self.not_dissipative:
            names = ", ".join(self.not_dissipative)
            lines.append(f"note: {names} below zero would feed energy in: 0 in the URDF, as estimated in the sidecar")
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


def sidecar_of(urdf: Path) -> Path:
    """Return the path of the sidecar of a URDF: ``leg.exoid.json`` for ``leg.urdf``."""
    return urdf.with_name(f"{urdf.name.removesuffix('.urdf')}.exoid.json")


def export_urdf(
    estimate: EstimateData, path: str | os.PathLike[str], *, pull: float = PULL, mass_factor: float = MASS_FACTOR
) -> Export:
    """Write an estimate as a URDF with a sidecar; see :meth:`Estimate.to_urdf`."""
    urdf = Path(path)
    sidecar = sidecar_of(urdf) if urdf.name else urdf
    if sidecar == urdf:
        raise BadArgumentError(f"{str(path)!r} is no name for a URDF", remedy="give a file such as leg.urdf")
    leg = estimate.model.leg
    for file in (urdf, sidecar):
        refuse_content(file, [leg.description.sha256, *(each.sha256 for each in estimate.inputs)])
        refuse_unwritable(file)
    p = len(leg.parameter_names)
    lifted = lift(leg, estimate.values[:p], estimate.covariance[:p, :p], pull=pull, mass_factor=mass_factor)
    links = distribute_bodies(leg, lifted.link_parameters, mass_factor)
    masses = mass_changes(leg.description, links)
    refuse_mass_changes(masses, mass_factor, leg.description.name)
    values = estimate.values if lifted.feasible else _moved_along(estimate, lifted.values)
    dynamics: dict[str, dict[str, float]] = {}
    places, value_of = places_of(estimate.model, PLACES), dict(zip(estimate.names, values.tolist(), strict=True))
    present = {name: place for name, place in places.items() if name in value_of}
    for name, (joint, attribute) in present.items():
        dynamics.setdefault(leg.joint_names[joint], {})[attribute] = max(0.0, value_of[name])
    negative = tuple(name for name in present if value_of[name] < 0.0)
    friction = f" and <dynamics> of {', '.join(dynamics)}" if dynamics else ""
    note = (
        f"exoid: <inertial> of {', '.join(links)}{friction} are identified, see {sidecar.name};\n"
        f"masses, which motion does not reveal, are nearest to {leg.description.name}; all else is as it was there."
    )
    text = rewrite(leg.description, links, dynamics, note)
    result = Export(urdf, sidecar, estimate, lifted, values, masses, negative)
    beside = json.dumps(result.to_json(), indent=1, ensure_ascii=False)
    write_together({urdf: text, sidecar: f"{beside}\n"})
    return result


def _moved_along(estimate: EstimateData, rigid: FloatArray) -> FloatArray:
    """All values, given those of the rigid bodies: the others at the minimum of (β − β̂)ᵀ C⁻¹ (β − β̂)."""
    p = len(rigid)
    values = estimate.values.copy()
    pull = scaled_inverse(estimate.covariance[:p, :p]) @ (rigid - values[:p])
    values[p:] += estimate.covariance[p:, :p] @ pull
    values[:p] = rigid
    return values


def places_of(model: TorqueModel, places: Mapping[tuple[type[Term], str], str]) -> dict[str, tuple[int, str]]:
    """Joint and attribute for each parameter that a file has a place for."""
    return {
        name: (block.joints[0], places[type(block.term), symbol])
        for block in model.blocks
        for symbol, name in zip(block.term.symbols, block.names, strict=True)
        if (type(block.term), symbol) in places
    }


def _term_of(model: TorqueModel, terms: Sequence[str]) -> dict[str, str]:
    """Name of the term that each parameter beside the rigid bodies belongs to."""
    known = dict(zip(map(id, model.terms), terms, strict=True))
    return {name: known[id(block.term)] for block in model.blocks for name in block.names if name in model.names}
