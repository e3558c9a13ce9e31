"""Header and source of a law in C99: fills the templates ``law.h.jinja`` and ``law.c.jinja``."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid._version import __version__
from exoid.codegen.arrays import initializer
from exoid.codegen.constants import Constants, constants_of_bodies
from exoid.codegen.dialect import Dialect, identifier
from exoid.codegen.templates import fill
from exoid.errors import ExoidError
from exoid.leg.reduction.planar import GRAVITY
from exoid.tools.files import write_whole

from .law_in_c import ArrayInC, LawInC, LegInC
from .safety import Safety, per_joint
from .source import LawSource

ABSURD = 1e9
"""Size from which an input or a torque is absurd in any unit; it also stands for a limit that was not given."""

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


def write_law(
    path: str | os.PathLike[str],
    law: LawInC,
    dialect: Dialect,
    *,
    title: str = "a leg",
    safety: Safety | None = None,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> LawSource:
    """Write a law as a source and, beside it, a header.

    Args:
        path: Source to write, such as ``law.c``; the header is ``law.h``.
        law: The law.
        dialect: Precision in which its expressions are written.
        title: What the law is for, for the comment.
        safety: Watchdog and safe torque; None for the default.
        provenance: Lines on the origin of the numbers, for the comment.
        warnings: Warnings for the result.

    Returns:
        The texts that were written, with the file.

    Raises:
        ExoidError: As for :func:`law_source`, the file does not end in ``.c``, or it cannot be written.
    """
    if Path(path).suffix != ".c":
        raise ExoidError("a law is a source and a header", where=str(path), remedy="name the source: LAW.c")
    source = law_source(
        law, dialect, name=Path(path).name, title=title, safety=safety, provenance=provenance, warnings=warnings
    )
    source = replace(source, path=Path(path))
    write_whole(path, [source.source])
    write_whole(Path(path).with_name(source.header_name), [source.header])
    return source


def law_source(
    law: LawInC,
    dialect: Dialect,
    *,
    name: str = "law",
    title: str = "a leg",
    safety: Safety | None = None,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> LawSource:
    """Turn a law into C99, without writing files.

    Args:
        law: The law.
        dialect: Precision in which its expressions are written.
        name: Name of the file and prefix of every name in C.
        title: What the law is for, for the comment.
        safety: Watchdog and safe torque; None for the default.
        provenance: Lines on the origin of the numbers, for the comment.
        warnings: Warnings for the result.

    Returns:
        Header and source.

    Raises:
        ExoidError: The safe torque needs a model that the law does not have, a setting is for another number of joints,
            or a number cannot be written.
    """
    safety, prefix, n = safety or Safety(), identifier(name), len(law.joints)
    if safety.safe == "gravity" and law.leg is None:
        raise ExoidError("a law without a model knows no gravity for its safe torque", remedy='use "damping" or "zero"')
    damping = safety.gains(law.damping)
    values = {
        "p": prefix,
        "law": law,
        "equation": law.equation,
        "rate": law.rate,
        "title": title,
        "version": __version__,
        "header": f"{prefix}.h",
        "provenance": provenance,
        "patience": safety.steps(law.rate),
        "targets": any(each.source == "target" for each in law.inputs),
        "keeps": safety.safe == "gravity",
        "uses_measured": bool(damping.any()),
        "uses_state": "state->" in law.step,
        "safety": describe_safety(safety, law),
        "dimensions": _dimensions,
    }
    needed = _needed(law, safety)
    inside = {
        **values,
        "needed": needed,
        "gravity": GRAVITY,
        "cumulative": law.leg is not None and law.leg.leg.cumulative,
        "tables": [] if law.leg is None else list(_tables(law.leg, needed, dialect)),
        "arrays": [*law.tables, *_settings(law, damping, n)],
        "initial": lambda array: initializer(array.values, dialect),
        "initial_memory": "".join(_at_first(law.memory, dialect)),
        "plausible": lambda origin: _plausible(law, origin, prefix),
    }
    names = {"p": prefix, "N": f"{prefix.upper()}_JOINTS", "real": f"{prefix}_real", "rate": law.rate}
    texts = {"step": law.step, "begin": law.begin, "helpers": law.helpers}
    inside |= {key: fill(f"{text.rstrip()}\n", dialect, **names) if text else "" for key, text in texts.items()}
    source = fill("laws/law.c.jinja", dialect, **inside).replace("\n\n\n", "\n\n")
    header = fill("laws/law.h.jinja", dialect, **values)
    return LawSource(header, source, prefix, dialect, law, safety, tuple(warnings))


def _needed(law: LawInC, safety: Safety) -> frozenset[str]:
    """Parts of the file, from the functions that are called."""
    called = () if law.leg is None else law.leg.needed
    kept = ("gravity", "springs") if safety.safe == "gravity" else ()
    return frozenset().union(*(INSIDE[function] for function in (*called, *kept)))


def _tables(leg: LegInC, needed: frozenset[str], dialect: Dialect) -> Iterator[Constants]:
    """Constants of the leg that the functions use; unused ones would be warnings."""
    bodies, joints = leg.leg, leg.leg.joint_names
    if bodies.chain is None:
        raise ExoidError(
            "only a planar chain of revolute joints under gravity of 9.81 m/s² has closed equations to write in C",
            where=bodies.description.name,
            remedy="choose joints whose axes are horizontal and parallel (joints=...)",
        )
    known = dict(zip(bodies.parameter_names, bodies.parameters.tolist(), strict=True))
    rotors = [(f"rotor of {joint}", inertia) for joint, inertia in zip(joints, leg.rotor, strict=True)]
    tables = (
        *constants_of_bodies(bodies, known, dialect),
        Constants("rotor", "where it is a separate parameter [kg m^2]", rotors),
    )
    yield from (table for table in tables if PARTS[table.name] in needed)


def _settings(law: LawInC, damping: FloatArray, n: int) -> Iterator[ArrayInC]:
    """Tables of limits and damping."""
    limit, slew = per_joint(law.limit, "limit", n), per_joint(law.slew, "slew", n)
    without = f"; {ABSURD:g} for none"
    yield ArrayInC("largest", f"largest torque [N m]{without}", np.minimum(limit, ABSURD))
    yield ArrayInC(
        "change", f"largest change of the torque in one step [N m]{without}", np.minimum(slew / law.rate, ABSURD)
    )
    yield ArrayInC("absurd", "size from which a number is absurd", np.array(ABSURD))
    if damping.any():
        yield ArrayInC("safe_damping", "damping of the safe torque [N m s/rad]", damping)


def _dimensions(array: ArrayInC) -> str:
    return "".join(f"[{size}]" for size in array.values.shape)


def _at_first(memory: Sequence[ArrayInC], dialect: Dialect) -> Iterator[str]:
    """Statements that set the memory."""
    for array in memory:
        for index, value in np.ndenumerate(array.values):
            place = "".join(f"[{k}]" for k in index)
            yield f"    state->{array.name}{place} = {dialect.number(float(value))};\n"


def _plausible(law: LawInC, source: str, prefix: str) -> str:
    """Condition that the measurements, or the reference, are plausible."""
    joints = f"{prefix.upper()}_JOINTS"
    measured = [f"{prefix}_plausible(in->{name}, {joints})" for name in ("q", "v")] if source == "reading" else []
    others = [
        f"{prefix}_plausible(&in->{each.name}, 1)" if each.scalar else f"{prefix}_plausible(in->{each.name}, {joints})"
        for each in law.inputs
        if each.source == source
    ]
    return " && ".join((*measured, *others))


def describe_safety(safety: Safety, law: LawInC) -> str:
    """Say in one line what the safe torque is."""
    damping = safety.gains(law.damping)
    numbers = ", ".join(f"{value:.4g}" for value in damping)
    damped = f"damping of {numbers} N m s/rad while the velocity is known, otherwise zero" if damping.any() else ""
    if safety.safe == "gravity":
        return "gravity and springs at the last valid angles" + (f", and {damped}" if damped else "")
    return damped or "zero"
