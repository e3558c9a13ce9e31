"""Reader of exported legs: the URDF, and its sidecar with the parameters that a URDF cannot hold."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.tools.files import read_json
from exoid.tools.numbers import is_number

from .description import Description, read_description
from .leg import Leg
from .leg_data import Base
from .loops import Loops

SCHEMA = "exoid-sidecar-1"

IN_URDF = {"c0": "friction", "d": "damping"}
"""Attributes of ``<dynamics>`` by symbol of the term."""

OFFSET = "offset"
"""Symbol and term of what is not of the leg but of its torque sensors."""

ROTOR, ROTOR_TERM = "Ia", "armature"
"""Symbol and term of rotor inertia."""

REMEDY = "export the estimate again, or remove the file to use the URDF alone"


class Exported(NamedTuple):
    """Content of a URDF and its sidecar."""

    leg: Leg  # the rigid bodies
    # what acts on the joints besides: `c0_hip`, `d_hip`, `Ia_hip`, … Friction below zero, which was not
    # dissipative, is zero as in the URDF; so is rotor inertia below zero, which was noise. Parameters of terms
    # from outside exoid are among them; `parameter_terms` tells the term of each
    resistances: Mapping[str, float]
    offsets: FloatArray  # zero of each joint's torque sensor [N·m], (n,)


def sidecar_of(urdf: Path) -> Path:
    """Return the path of the sidecar of a URDF: ``leg.exoid.json`` for ``leg.urdf``."""
    return urdf.with_name(f"{urdf.name.removesuffix('.urdf')}.exoid.json")


def read_exported(path: str | Path, joints: Sequence[str] | None = None) -> Exported:
    """Read a leg that :meth:`exoid.Estimate.to_urdf` wrote, or any URDF with ``<dynamics friction damping>``."""
    urdf = Path(path)
    description = read_description(urdf)
    sidecar = sidecar_of(urdf)
    if not sidecar.is_file():
        leg = Leg.from_description(description, joints)
        return Exported(leg, _dynamics(description, leg), np.zeros(len(leg.joint_names)))
    data = _read(sidecar, description)
    if joints is not None and list(joints) != data["joints"]:
        raise BadArgumentError(
            f"the sidecar has joints {', '.join(data['joints'])}, not {', '.join(joints)}",
            file=str(sidecar),
            remedy="omit the argument joints",
        )
    leg = Leg.from_description(
        description,
        data["joints"],
        locked=data["locked"],
        cumulative=data["cumulative"],
        base=data.get("base", "fixed"),
        contacts=data.get("contacts"),
        loops=Loops.from_data(data["loops"]) if data.get("loops") else None,
    )
    beside = {name: value for name, value in data["values"].items() if name not in leg.parameter_names}
    beside |= dict.fromkeys(data["not_dissipative"], 0.0)
    terms = data.get("term_of", {})
    for name in [f"{ROTOR}_{label}" for label in leg.joint_labels]:
        if name in beside and terms.get(name, ROTOR_TERM) == ROTOR_TERM:
            beside[name] = max(0.0, beside[name])
    names = [f"{OFFSET}_{label}" for label in leg.joint_labels]
    offsets = np.array([beside.pop(name, 0.0) if terms.get(name, OFFSET) == OFFSET else 0.0 for name in names])
    return Exported(leg, beside, offsets)


def parameter_terms(path: str | Path) -> dict[str, str]:
    """Read which term each parameter beside the rigid bodies belongs to."""
    sidecar = sidecar_of(Path(path))
    return dict(_read(sidecar, read_description(path)).get("term_of", {})) if sidecar.is_file() else {}


def _dynamics(description: Description, leg: Leg) -> dict[str, float]:
    """Friction and damping of the moving joints in the URDF."""
    root = description.parse()
    found = {}
    for name, label in zip(leg.joint_names, leg.joint_labels, strict=True):
        element = next((joint.find("dynamics") for joint in root.findall("joint") if joint.get("name") == name), None)
        for symbol, attribute in IN_URDF.items():
            text = "0" if element is None else element.get(attribute, "0")
            try:
                value = float(text)
            except ValueError:
                value = math.nan
            if not 0.0 <= value < math.inf:
                raise UnreadableInputError(
                    f"<dynamics {attribute}={text!r}> is not a finite number ≥ 0",
                    where=f"{description.name}, joint {name!r}",
                    remedy="write a decimal number",
                )
            found[f"{symbol}_{label}"] = value
    return found


def _read(sidecar: Path, description: Description) -> dict[str, Any]:
    """Read and check a sidecar."""

    def refusal(what: str) -> UnreadableInputError:
        """Error of this file."""
        return UnreadableInputError(what, file=str(sidecar), remedy=REMEDY)

    data = read_json(sidecar, "sidecar", SCHEMA, REMEDY)
    if not _is_complete(data):
        raise refusal("a field of the sidecar is missing or of the wrong type")
    if data["urdf"]["sha256"] != description.sha256:
        raise refusal(f"belongs to another {description.name}: the URDF has changed since the export")
    return data


def _is_complete(data: Mapping[str, Any]) -> bool:
    """Check that all fields exist and have the right type."""
    names, numbers = (data.get(key) for key in ("joints", "not_dissipative")), [data.get("locked"), data.get("values")]
    terms = data.get("term_of", {})  # older sidecars have none
    return (
        isinstance(data.get("urdf"), dict)
        and isinstance(data["urdf"].get("sha256"), str)
        and isinstance(data.get("cumulative"), bool)
        and all(isinstance(x, list) and all(isinstance(name, str) for name in x) for x in names)
        and all(isinstance(x, dict) and all(is_number(value) for value in x.values()) for x in numbers)
        and data.get("base", "fixed") in get_args(Base)
        and all(isinstance(x, dict) for x in (terms, data.get("contacts", {}), data.get("loops", {})))
        and all(isinstance(term, str) for term in terms.values())
    )
