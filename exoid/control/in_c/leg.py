"""Model of a controller as expressions in C."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import Dialect
from exoid.codegen.forms import c_form
from exoid.codegen.laws import LegInC, Needed
from exoid.codegen.terms import torques_in_c
from exoid.control.friction import FrictionCompensation
from exoid.control.model import ControlModel
from exoid.control.other_term import OtherTerm
from exoid.control.standard_laws import default_gains
from exoid.errors import ExoidError
from exoid.torques.term import TermBlock


def leg_in_c(
    model: ControlModel, needed: Sequence[Needed], friction: FrictionCompensation | None, dialect: Dialect
) -> LegInC:
    """Write the model of a controller: its springs, friction and rotors as expressions.

    Args:
        model: The model.
        needed: Functions of the leg that the law calls; friction is added to them if it is compensated.
        friction: Friction compensation; None for none.
        dialect: Precision.

    Returns:
        The leg for C.

    Raises:
        ExoidError: A term of the model has no form in C, or a number cannot be written.
    """
    number, n = dialect.number, model.n
    springs = [[_polynomial(row, f"q[{j}]", dialect)] for j, row in enumerate(model.spring.T.tolist())]
    sliding = [_plain_friction(model, friction, j, dialect) for j in range(n)]
    rotor = [[number(inertia)] for inertia in model.armature.tolist()]
    places = {"stiffness": springs, "friction": sliding, "rotor": rotor}
    scale = 0.0 if friction is None else friction.scale
    for other in model.others:
        place = c_form(other.term).place
        share = scale if place == "friction" else 1.0
        if place == "friction":
            _refuse_torque_at_rest(other, n)
        parameters = {
            symbol: _constant(share * value, dialect)
            for symbol, value in zip(other.term.symbols, other.values.tolist(), strict=True)
        }
        for joint, expression in torques_in_c(TermBlock(other.term, other.joints, ()), parameters, dialect):
            places[place][joint].append(expression)
    sums = {place: tuple(_sum(each, dialect) for each in of_joints) for place, of_joints in places.items()}
    called = (*needed, *(() if friction is None else ("friction",)))
    return LegInC(model.leg, sums["stiffness"], sums["friction"], sums["rotor"], called)


def damping_of(model: ControlModel) -> FloatArray:
    """Choose the damping of the safe torque: the default Kd of controllers, at the zero pose."""
    return default_gains(model, np.zeros(model.n))[1]


def compensated(friction: FrictionCompensation | None) -> str:
    """Write the statement that compensates friction."""
    if friction is None:
        return "    for (j = 0; j < {{N}}; ++j) {\n        friction[j] = {{number(0)}};\n    }"
    return f"    {{{{p}}}}_friction(in->{'v_d' if friction.velocity == 'desired' else 'v'}, friction);"


def friction_in_words(friction: FrictionCompensation | None) -> str:
    """Write the friction compensation for an equation in a comment."""
    if friction is None:
        return ""
    share = "" if friction.scale == 1.0 else f"{friction.scale:g} "
    return f" + {share}F({'v_d' if friction.velocity == 'desired' else 'v'})"


def _sum(parts: Sequence[str], dialect: Dialect) -> str:
    return " + ".join(part for part in parts if part) or dialect.number(0.0)


def _constant(value: float, dialect: Dialect) -> str:
    """Write a constant so that an operator may stand before it."""
    return dialect.number(value) if value >= 0.0 else f"({dialect.number(value)})"


def _polynomial(coefficients: Sequence[float], variable: str, dialect: Dialect) -> str:
    """Horner's scheme, highest power first; empty if all are zero."""
    text = ""
    for coefficient in np.trim_zeros(np.array(coefficients), "f").tolist():
        constant = _constant(coefficient, dialect)
        factor = f"({text})" if " + " in text else text
        text = f"{factor} * {variable} + {constant}" if text else constant
    return text


def _plain_friction(
    model: ControlModel, friction: FrictionCompensation | None, joint: int, dialect: Dialect
) -> list[str]:
    """Coulomb and viscous friction as a controller computes them, c0 tanh(v / width) + d v."""
    if friction is None:
        return []
    coulomb, viscous = (float(friction.scale * row[joint]) for row in (model.coulomb, model.viscous))
    v, zero, one = f"v[{joint}]", dialect.number(0.0), dialect.number(1.0)
    sign = f"({v} > {zero} ? {one} : {v} < {zero} ? -{one} : {zero})"
    if friction.width > 0.0:
        sign = f"{dialect.function('tanh')}({v} / {dialect.number(friction.width)})"
    parts = [(coulomb, sign), (viscous, v)]
    return [f"{_constant(constant, dialect)} * {factor}" for constant, factor in parts if constant != 0.0]


def _refuse_torque_at_rest(other: OtherTerm, n: int) -> None:
    """Refuse friction that is not zero at rest: a controller counts its torque at rest as a spring."""
    still = np.zeros((n, 1))
    if other.torque(still, still, still, still).any():
        raise ExoidError(
            f"{type(other.term).__name__} has a torque at rest, which laws in C do not have",
            remedy='write its form with the place "stiffness", or as two terms',
        )
