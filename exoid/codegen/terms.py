"""Terms beside the rigid bodies as expressions in C."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple, get_args

from exoid._typing import FloatArray
from exoid.torques import (
    Armature,
    CoordinateTerm,
    Coulomb,
    CouplingFriction,
    CouplingSpring,
    Offset,
    Stiffness,
    Stribeck,
    TorqueModel,
    Viscous,
)
from exoid.torques.term import TermBlock
from exoid.torques.terms import DryFriction

from .dialect import Dialect
from .forms import FORMS, CForm, JointInC, Place, c_form


class TermsInC(NamedTuple):
    """The terms of a leg."""

    friction: list[str]  # torque of each joint as an expression in v[j], n of them
    stiffness: list[str]  # torque of each joint as an expression in q[j], n of them
    rotor: list[str]  # inertia of each joint as a constant expression, n of them
    table: list[str]  # names of the parameters in the table that friction and stiffness refer to, in its order


def terms_in_c(model: TorqueModel, values: FloatArray, table: str, dialect: Dialect) -> TermsInC:
    """Write all terms of a model."""
    known = {name: dialect.number(value) for name, value in zip(model.names, values, strict=True)}
    forms = [(block, c_form(block.term)) for block in model.blocks if any(name in known for name in block.names)]
    tabled = [
        name for block, form in forms if form.place != "rotor" for name in block.names if name in known
    ]  # an inertia initialises a table itself, where C99 wants numbers
    constants = {**known, **{name: f"{table}[{index}]" for index, name in enumerate(tabled)}}
    summands: dict[Place, list[list[str]]] = {place: [[] for _ in model.leg.joint_names] for place in get_args(Place)}
    for block, form in forms:
        symbols = zip(block.term.symbols, block.names, strict=True)
        parameters = {symbol: constants[name] for symbol, name in symbols if name in constants}
        for joint, expression in torques_in_c(block, parameters, dialect):
            summands[form.place][joint].append(expression)
    zero = dialect.number(0.0)
    sums = {place: [" + ".join(joint) or zero for joint in joints] for place, joints in summands.items()}
    return TermsInC(sums["friction"], sums["stiffness"], sums["rotor"], tabled)


def torques_in_c(block: TermBlock, parameters: Mapping[str, str], dialect: Dialect) -> Iterator[tuple[int, str]]:
    """Write the torque of one term at each of its joints, in q[j] or v[j] by the place of its form."""
    form = c_form(block.term)
    variables = [{"friction": f"v[{j}]", "stiffness": f"q[{j}]", "rotor": ""}[form.place] for j in block.joints]
    if not isinstance(block.term, CoordinateTerm):
        yield block.joints[0], _summand(form.write(block.term, JointInC(variables[0], parameters, dialect)))
        return
    ratios = [dialect.number(ratio) for ratio in block.term.ratios]
    coordinate = " + ".join(f"{ratio} * {variable}" for ratio, variable in zip(ratios, variables, strict=True))
    along = form.write(block.term, JointInC(f"({coordinate})", parameters, dialect))
    for joint, ratio in zip(block.joints, ratios, strict=True):
        yield joint, _summand(f"{ratio} * ({along})")


def term_columns(model: TorqueModel) -> list[tuple[str, int, str]]:
    """Write the columns of the terms: parameter, joint, and expression in q[j], v[j] and a[j] of each."""
    found = []
    for block in model.blocks:
        rotor = c_form(block.term).place == "rotor"
        for symbol, name in zip(block.term.symbols, block.names, strict=True):
            unit = {each: "1.0" if each == symbol else "0.0" for each in block.term.symbols}
            for joint, text in torques_in_c(block, unit, Dialect()) if name in model.names else ():
                found.append((name, joint, f"{text} * a[{joint}]" if rotor else text))
    return found


def _summand(expression: str) -> str:
    """Put parentheses around an expression that ends in an operator weaker than a sum, such as a conditional."""
    outside, inside = "", expression  # parentheses are taken away from the innermost outwards
    while outside != inside:
        outside, inside = inside, re.sub(r"\([^()]*\)", "", inside)
    return f"({expression})" if re.search("[?<>=!&|^,]", outside) else expression


def _stiffness(term: Stiffness, joint: JointInC) -> str:
    """Horner's scheme; a power whose parameter is regrouped has no coefficient."""
    text = joint.parameters.get(term.symbols[0], "")
    for symbol in term.symbols[1:]:
        text = f"{f'({text})' if ' + ' in text else text} * {joint.variable}" if text else ""
        text = " + ".join(part for part in (text, joint.parameters.get(symbol, "")) if part)
    return text


def _stribeck(term: Stribeck, joint: JointInC) -> str:
    ratio = f"({joint.variable} / {joint.number(term.velocity)})"
    return _dry(term, f"{joint.parameters['cs']} * {joint.function('exp')}(-{ratio} * {ratio})", joint)


def _dry(term: DryFriction, size: str, joint: JointInC) -> str:
    """Write a size times the direction of motion, zero in the dead band."""
    v, zero = joint.variable, joint.number(0.0)
    torque = f"{size} * {_direction(term.smoothing, joint)}"
    if term.dead_band > 0.0:
        torque = f"({joint.function('fabs')}({v}) > {joint.number(term.dead_band)} ? {torque} : {zero})"
    return torque


def _direction(smoothing: float, joint: JointInC) -> str:
    """Write the direction of motion, smooth or sharp."""
    v, zero = joint.variable, joint.number(0.0)
    if smoothing > 0.0:
        return f"{joint.function('tanh')}({v} / {joint.number(smoothing)})"
    return f"({v} > {zero} ? {joint.number(1.0)} : {v} < {zero} ? {joint.number(-1.0)} : {v})"


FORMS |= {
    Armature: CForm("rotor", lambda term, joint: joint.parameters["Ia"]),
    Coulomb: CForm("friction", lambda term, joint: _dry(term, joint.parameters["c0"], joint)),
    Offset: CForm("stiffness", lambda term, joint: joint.parameters["offset"]),
    Stiffness: CForm("stiffness", _stiffness),
    Stribeck: CForm("friction", _stribeck),
    Viscous: CForm("friction", lambda term, joint: f"{joint.parameters['d']} * {joint.variable}"),
    CouplingFriction: CForm(
        "friction",
        lambda term, joint: (
            f"{joint.parameter('c0')} * {_direction(term.smoothing, joint)} + {joint.parameter('d')} * {joint.variable}"
        ),
    ),
    CouplingSpring: CForm(
        "stiffness", lambda term, joint: f"{joint.parameter('k')} * {joint.variable} + {joint.parameter('preload')}"
    ),
}
