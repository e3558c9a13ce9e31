"""One C99 file from a torque model and its values: fills the template ``leg.c.jinja``."""

from __future__ import annotations

from collections.abc import Sequence

from exoid._typing import ArrayLike
from exoid._version import __version__
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.leg.reduction.planar import GRAVITY
from exoid.tools.json_values import named
from exoid.tools.numbers import checked
from exoid.torques import TorqueModel

from .constants import Constants, constants_of_bodies
from .dialect import Dialect, identifier
from .drives import commands_in_c
from .source import CSource
from .templates import fill
from .terms import terms_in_c
from .tree import tree_in_c


def leg_source(
    model: TorqueModel,
    values: ArrayLike | None,
    dialect: Dialect,
    name: str,
    actuators: Actuators | None,
    provenance: Sequence[str],
    warnings: tuple[str, ...],
) -> CSource:
    """Turn the torques of a leg into C99."""
    prefix, leg = identifier(name), model.leg
    numbers = checked(() if values is None else values, "the values of a leg")
    if numbers.shape != (len(model.names),):
        what = f"{numbers.size} values of {len(model.names)} parameters"
        raise BadArgumentError(what, remedy=f"give one for each of {', '.join(model.names)}")
    terms, known = terms_in_c(model, numbers, f"{prefix}_term", dialect), named(model.names, numbers)
    units = named(model.names, model.units)
    tables = list(constants_of_bodies(leg, known, terms.rotor, dialect))
    if terms.table:
        rows = [(f"{each} [{units[each]}]", dialect.number(known[each])) for each in terms.table]
        tables.append(Constants("term", "friction, springs and offsets", rows))
    text = fill(
        "leg.c.jinja",
        dialect,
        p=prefix,
        urdf=leg.description,
        version=__version__,
        joints=leg.joint_names,
        cumulative=leg.cumulative,
        gravity=GRAVITY,
        tree=tree_in_c(leg, numbers[: len(leg.parameter_names)], dialect),
        provenance=provenance,
        tables=tables,
        terms=terms,
        commands=[] if actuators is None else commands_in_c(actuators, dialect),
        units=() if actuators is None else actuators.units,
    )
    names = ["gravity", "friction", "stiffness", "mass_matrix", "rigid_bodies", "inverse_dynamics"]
    functions = tuple(f"{prefix}_{each}" for each in [*names, *(["command"] if actuators is not None else [])])
    facts = {
        "schema": "exoid-c-1",
        "precision": dialect.real,
        "functions": list(functions),
        "joints": list(leg.joint_names),
        "values": known,
        "units": units,
        "merged": {regrouped.name: regrouped.into for regrouped in model.regrouped},
    }
    joints = ", ".join(leg.joint_names)
    summary = (
        f"{dialect.real} precision, C99, needs <math.h> only; joints in the order {joints}",
        f"functions: {', '.join(functions)}",
        f"to call them from another file: #define {prefix.upper()}_DECLARATIONS_ONLY, then #include it",
        *(f"note: {regrouped}" for regrouped in model.regrouped),
    )
    return CSource({f"{prefix}.c": text}, prefix, dialect, model, functions, facts, summary, warnings)
