"""One C99 file from a torque model and its values: fills the template ``planar_leg.c.jinja``."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid._version import __version__
from exoid.actuators import Actuators
from exoid.errors import ExoidError
from exoid.leg.fixed_base import refuse_floating_base
from exoid.leg.reduction.planar import GRAVITY
from exoid.tools.files import write_whole
from exoid.torques import TorqueModel

from .constants import Constants, constants_of_bodies
from .dialect import Dialect, identifier
from .drives import commands_in_c
from .source import CSource
from .templates import fill
from .terms import TermsInC, terms_in_c

TEMPLATE = "planar_leg.c.jinja"


def write_c(
    path: str | os.PathLike[str],
    model: TorqueModel,
    values: ArrayLike,
    *,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
    precision: str = "double",
    name: str | None = None,
    actuators: Actuators | None = None,
) -> CSource:
    """Write the torques of a planar leg as one C99 file.

    Args:
        path: File to write, whole or not at all.
        model: Leg and terms; see :func:`c_source`.
        values: Parameters in SI units, in the order of ``model.names``, (P,).
        provenance: Lines on the origin of the values, for the comment at the top.
        warnings: Warnings about the values, for the result.
        precision: "double" or "float".
        name: Prefix of every name in C; None for the file's.
        actuators: Drives; a function then turns torques into their commands. None for no such function.

    Returns:
        The text that was written, with its file.

    Raises:
        ExoidError: As for :func:`c_source`, or the file cannot be written.
    """
    source = c_source(
        model,
        values,
        provenance=provenance,
        warnings=warnings,
        precision=precision,
        name=name or Path(path).name,
        actuators=actuators,
    )
    write_whole(path, [source.text])
    return replace(source, path=Path(path))


def c_source(
    model: TorqueModel,
    values: ArrayLike,
    *,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
    precision: str = "double",
    name: str = "leg",
    actuators: Actuators | None = None,
) -> CSource:
    """Turn the torques of a planar leg into C99, without writing a file.

    The functions compute τ = W(q, v, a) β of :class:`exoid.torques.TorqueModel`, whole and in parts.

    Args:
        model: Leg, a planar chain, and terms that have a form in C (:func:`register_c_form`).
        values: Parameters β in SI units, in the order of ``model.names``, (P,).
        provenance: Lines on the origin of the values, for the comment at the top: an estimate's estimator, data,
            warnings and standard deviations. No line can end the comment.
        warnings: Warnings about the values. The result prints them; the file has only the provenance.
        precision: "double" or "float".
        name: Prefix of every name in C; characters that no identifier can have are replaced.
        actuators: Drives; the function ``command`` then turns torques into currents, forces or motor angles.

    Returns:
        Text of the file, with model and values.

    Raises:
        ExoidError: The leg is not a planar chain, or its base floats, a term or a drive has no form in C, the values
            are not P finite numbers, or a name or number cannot be written.

    Example:
        >>> leg = exoid.load_leg("cuhk")
        >>> source = c_source(TorqueModel(leg, ()), leg.parameters, precision="float")
        >>> source.functions[:2]
        ('leg_gravity', 'leg_friction')
    """
    dialect, prefix, leg = Dialect(precision), identifier(name), model.leg
    refuse_floating_base(leg, "code of a leg")
    if leg.chain is None:
        raise ExoidError(
            "only a planar chain of revolute joints under gravity of 9.81 m/s² has closed equations to write in C",
            where=leg.description.name,
            remedy="choose joints whose axes are horizontal and parallel (joints=...), or use Pinocchio's own code "
            "generation on the URDF that exoid export -o writes",
        )
    numbers = _checked(model, values)
    terms = terms_in_c(model, numbers, f"{prefix}_term", dialect)
    text = fill(
        TEMPLATE,
        dialect,
        p=prefix,
        urdf=leg.description,
        version=__version__,
        joints=leg.joint_names,
        cumulative=leg.cumulative,
        gravity=GRAVITY,
        provenance=provenance,
        tables=list(_tables(model, numbers, terms, dialect)),
        terms=terms,
        commands=[] if actuators is None else commands_in_c(actuators, dialect),
        units=() if actuators is None else actuators.units,
    )
    return CSource(text, prefix, dialect, model, numbers, tuple(warnings), commands=actuators is not None)


def _checked(model: TorqueModel, values: ArrayLike) -> FloatArray:
    """Copy the values, (P,), and forbid changes."""
    numbers = np.array(values, dtype=np.float64)
    if numbers.shape != (len(model.names),) or not np.isfinite(numbers).all():
        raise ExoidError(
            f"values of shape {numbers.shape} must be {len(model.names)} finite numbers",
            remedy=f"give one for each of {', '.join(model.names)}",
        )
    numbers.flags.writeable = False
    return numbers


def _tables(model: TorqueModel, values: FloatArray, terms: TermsInC, dialect: Dialect) -> Iterator[Constants]:
    """Tables of the template, each number with its label."""
    known = dict(zip(model.names, values, strict=True))
    yield from constants_of_bodies(model.leg, known, dialect)
    rotors = [(f"rotor of {joint}", inertia) for joint, inertia in zip(model.leg.joint_names, terms.rotor, strict=True)]
    yield Constants("rotor", "where it is a separate parameter [kg m^2]", rotors)
    if terms.table:
        units = dict(zip(model.names, model.units, strict=True))
        rows = [(f"{name} [{units[name]}]", dialect.number(known[name])) for name in terms.table]
        yield Constants("term", "friction, springs and offsets", rows)
