"""Header and source of a law in C99: fills the templates ``law.h.jinja`` and ``law.c.jinja``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid._version import __version__
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.leg.joint_numbers import for_joints
from exoid.leg.reduction.planar import GRAVITY

from .constants import constants_of_bodies
from .dialect import ABSURD, Dialect, identifier
from .drives import commands_in_c
from .law_in_c import ArrayInC, InputInC, LawInC
from .safety import Safety
from .source import CSource
from .templates import fill
from .tree import tree_in_c


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
    readings = [InputInC("q", ""), InputInC("v", ""), *(each for each in law.inputs if each.source == "reading")]
    targets = [each for each in law.inputs if each.source == "target"]
    values = {
        "p": prefix,
        "law": law,
        "version": __version__,
        "header": f"{prefix}.h",
        "provenance": provenance,
        "patience": safety.steps(law.rate),
        "sources": {"reading": readings, **({"target": targets} if targets else {})},
        "keeps": safety.safe == "gravity",
        "uses_measured": bool(damping.any()),
        "safety": safety.describe(law.damping),
        "unlimited": unlimited,
        "commands": [] if actuators is None else commands_in_c(actuators, dialect),
        "units": () if actuators is None else actuators.units,
    }
    arrays = [*law.tables, *_settings(law, damping, n)]
    values |= {
        "arrays": arrays,
        "initial_memory": "".join(_at_first(law.memory, dialect)),
        **_model(law, safety, dialect),
    }
    names = {"p": prefix, "N": f"{prefix.upper()}_JOINTS", "real": f"{prefix}_real", "rate": law.rate}
    texts = {"step": law.step, "begin": law.begin, "helpers": law.helpers}
    values |= {key: fill(f"{text.rstrip()}\n", dialect, **names) if text else "" for key, text in texts.items()}
    source = fill("law.c.jinja", dialect, **values).replace("\n\n\n", "\n\n")
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


def _model(law: LawInC, safety: Safety, dialect: Dialect) -> dict[str, Any]:
    """Functions of the leg that the law and its safe torque call, and their tables; unused ones would be warnings."""
    needed: set[str] = {*(() if law.leg is None else law.leg.needed)}
    if safety.safe == "gravity":
        needed |= {"gravity", "springs"}
    if "inverse_dynamics" in needed:
        needed |= {"springs", "rigid_bodies"}
    with_rotors = needed & {"bodies", "inverse_dynamics", "mass_matrix"}
    if law.leg is None or not (with_rotors or needed & {"gravity", "rigid_bodies"}):
        return {"needed": needed, "rigid": False, "tree": None, "tables": ()}
    leg, rotor = law.leg.leg, law.leg.rotor if with_rotors else ()
    known = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))
    return {
        "needed": needed,
        "rigid": True,
        "gravity": GRAVITY,
        "cumulative": leg.cumulative,
        "tree": tree_in_c(leg, leg.parameters, dialect),
        "tables": list(constants_of_bodies(leg, known, rotor, dialect)),
    }


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
            number = str(value) if array.values.dtype.kind == "i" else dialect.number(float(value))
            yield f"    state->{array.name}{place} = {number};\n"
