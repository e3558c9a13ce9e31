"""Header and source of a law in C99: fills the templates ``law.h.jinja`` and ``law.c.jinja``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid._version import __version__
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.leg.joint_numbers import for_joints
from exoid.leg.reduction.planar import GRAVITY

from .constants import Constants, constants_of_bodies
from .dialect import ABSURD, Dialect, identifier
from .drives import commands_in_c
from .law_in_c import ArrayInC, LawInC, LegInC
from .safety import Safety
from .source import CSource
from .templates import fill
from .tree import tree_in_c

INSIDE: dict[str, frozenset[str]] = {
    "springs": frozenset({"springs"}),
    "friction": frozenset({"friction"}),
    "gravity": frozenset({"gravity", "rigid"}),
    "inverse_dynamics": frozenset({"inverse_dynamics", "springs", "rigid_bodies", "rotor", "turn", "rigid"}),
    "rigid_bodies": frozenset({"rigid_bodies", "turn", "rigid"}),
    "mass_matrix": frozenset({"mass_matrix", "rotor", "turn", "rigid"}),
}
"""Parts of the file that each function of the leg takes."""

PARTS = {"sign": "rigid", "X": "rigid", "Y": "rigid", "dx": "turn", "dz": "turn", "J": "turn", "rotor": "rotor"}
"""Part of the file that each table of the leg belongs to."""


def law_source(
    law: LawInC,
    dialect: Dialect,
    name: str,
    safety: Safety,
    provenance: Sequence[str],
    warnings: tuple[str, ...],
    actuators: Actuators | None = None,
) -> CSource:
    """Turn a law, whose expressions are written in this precision, into C99."""
    prefix, n = identifier(name), len(law.joints)
    if safety.safe == "gravity" and law.leg is None:
        what = "a law without a model knows no gravity for its safe torque"
        raise BadArgumentError(what, remedy='use "damping" or "zero"')
    damping = safety.gains(law.damping)
    free = [joint for joint, most in zip(law.joints, for_joints(law.limit, n, "limit"), strict=True) if np.isinf(most)]
    unlimited = f"no limit of the torque at {', '.join(free)}" if free and law.gives == LawInC.gives else ""
    if unlimited:
        warnings = (*warnings, f"{unlimited}: write Limited(law, limit) from Python, or give --limit")
    values = {
        "p": prefix,
        "law": law,
        "equation": law.equation,
        "rate": law.rate,
        "version": __version__,
        "header": f"{prefix}.h",
        "provenance": provenance,
        "patience": safety.steps(law.rate),
        "targets": any(each.source == "target" for each in law.inputs),
        "keeps": safety.safe == "gravity",
        "uses_measured": bool(damping.any()),
        "uses_state": "state->" in law.step,
        "safety": safety.describe(law.damping),
        "unlimited": unlimited,
        "commands": [] if actuators is None else commands_in_c(actuators, dialect),
        "units": () if actuators is None else actuators.units,
    }
    called = () if law.leg is None else law.leg.needed
    kept = ("gravity", "springs") if safety.safe == "gravity" else ()
    needed = frozenset().union(*(INSIDE[function] for function in (*called, *kept)))
    tree = None if law.leg is None or "rigid" not in needed else tree_in_c(law.leg.leg, law.leg.leg.parameters, dialect)
    if tree is not None and "rigid" in needed:
        needed |= {"turn"}  # one helper serves all functions of a tree
    inside = {
        **values,
        "needed": needed,
        "gravity": GRAVITY,
        "tree": tree,
        "cumulative": law.leg is not None and law.leg.leg.cumulative,
        "tables": [] if law.leg is None else list(_tables(law.leg, needed, dialect)),
        "arrays": [*law.tables, *_settings(law, damping, n)],
        "initial_memory": "".join(_at_first(law.memory, dialect)),
        "plausible": lambda origin: _plausible(law, origin, prefix),
    }
    names = {"p": prefix, "N": f"{prefix.upper()}_JOINTS", "real": f"{prefix}_real", "rate": law.rate}
    texts = {"step": law.step, "begin": law.begin, "helpers": law.helpers}
    inside |= {key: fill(f"{text.rstrip()}\n", dialect, **names) if text else "" for key, text in texts.items()}
    source = fill("law.c.jinja", dialect, **inside).replace("\n\n\n", "\n\n")
    header = fill("law.h.jinja", dialect, **values)
    functions = tuple(f"{prefix}_{each}" for each in ("init", "step", *(["command"] if actuators is not None else [])))
    inputs = ["q", "v", *(each.name for each in law.inputs)]
    facts = {
        "schema": "exoid-law-in-c-1",
        "equation": law.equation,
        "rate": law.rate,
        "precision": dialect.real,
        "functions": list(functions),
        "joints": list(law.joints),
        "inputs": inputs,
        "safe": safety.safe,
        "patience": safety.patience,
    }
    summary = (
        law.equation,
        f"{dialect.real} precision, C99, needs <math.h> only; joints: {', '.join(law.joints)}",
        f"functions: {', '.join(functions)}; {prefix}_step {law.rate:g} times a second",
        f"inputs: {', '.join(inputs)}",
    )
    files = {f"{prefix}.c": source, f"{prefix}.h": header}
    return CSource(files, prefix, dialect, law, functions, facts, summary, warnings)


def _tables(leg: LegInC, needed: frozenset[str], dialect: Dialect) -> Iterator[Constants]:
    """Constants of the leg that the functions use; unused ones would be warnings."""
    bodies, joints = leg.leg, leg.leg.joint_names
    known = dict(zip(bodies.parameter_names, bodies.parameters.tolist(), strict=True))
    rotors = [(f"rotor of {joint}", inertia) for joint, inertia in zip(joints, leg.rotor, strict=True)]
    tables = (
        *constants_of_bodies(bodies, known, dialect),
        Constants("rotor", "where it is a separate parameter [kg m^2]", rotors),
    )
    yield from (table for table in tables if PARTS[table.name] in needed)


def _settings(law: LawInC, damping: FloatArray, n: int) -> Iterator[ArrayInC]:
    """Tables of limits and damping."""
    limit, change = for_joints(law.limit, n, "limit"), for_joints(law.slew, n, "slew") / law.rate
    without = f"; {ABSURD:g} for none"
    # an infinite limit is a number so large that no torque reaches it: C99 has no literal for infinity
    yield ArrayInC("largest", f"largest torque [N m]{without}", np.minimum(limit, ABSURD))
    yield ArrayInC("change", f"largest change of the torque in one step [N m]{without}", np.minimum(change, ABSURD))
    yield ArrayInC("absurd", "size from which a number is absurd", np.array(ABSURD))
    if damping.any():
        yield ArrayInC("safe_damping", "damping of the safe torque [N m s/rad]", damping)


def _at_first(memory: Sequence[ArrayInC], dialect: Dialect) -> Iterator[str]:
    """Statements that set the memory."""
    for array in memory:
        for index, value in np.ndenumerate(array.values):
            place = "".join(f"[{k}]" for k in index)
            yield f"    state->{array.name}{place} = {dialect.number(float(value))};\n"


def _plausible(law: LawInC, source: str, prefix: str) -> str:
    """Condition that the measurements, or the reference, are plausible."""
    joints = f"{prefix.upper()}_JOINTS"
    measured = [("q", None), ("v", None)] if source == "reading" else []
    read = (*measured, *((each.name, each.size) for each in law.inputs if each.source == source))
    return " && ".join(f"{prefix}_plausible(in->{name}, {size or joints})" for name, size in read)
