"""Terms beside the rigid bodies as expressions in C."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

from exoid.errors import ExoidError
from exoid.torques import Armature, Coulomb, Offset, Stiffness, Stribeck, Term, TorqueModel, Viscous
from exoid.torques.dry_friction import DryFriction
from exoid.torques.nonlinear import number

from .dialect import Dialect

Place = Literal["friction", "stiffness", "rotor"]


class Expression(NamedTuple):
    """Torque of one term at one joint.

    Attributes:
        place: Function it belongs to, or the table of rotors.
        text: In C.
    """

    place: Place
    text: str


class JointTerm(NamedTuple):
    """One term at one joint.

    Attributes:
        term: The term.
        joint: Index of the joint.
        names: Full name of the parameter behind each of its symbols, those regrouped into others left out.
    """

    term: Term
    joint: int
    names: dict[str, str]


def joint_terms(model: TorqueModel) -> list[JointTerm]:
    """List the terms of each joint with the parameters that they have in an estimate."""
    names, labels = model.leg.joint_names, model.leg.joint_labels
    found = []
    for joint in range(len(names)):
        for term in model.terms:
            every = {symbol: f"{symbol}_{labels[joint]}" for symbol in term.symbols}
            kept = {symbol: name for symbol, name in every.items() if name in model.names}
            if joint in term.joint_indices(names, labels) and kept:
                found.append(JointTerm(term, joint, kept))
    return found


def express(term: Term, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    """Write a term in C.

    Args:
        term: The term.
        joint: Index of its joint.
        constants: What stands in C for each of its symbols; symbols regrouped into other parameters are missing.
        dialect: Precision.

    Raises:
        ExoidError: The term has no form in C.
    """
    if type(term) not in WRITERS or term.memory is not None:  # a subclass may compute something else
        known = ", ".join(kind.__name__ for kind in WRITERS)
        remembers = " and a memory" if term.memory is not None else ""
        raise ExoidError(
            f"{type(term).__name__} ({', '.join(constants)}){remembers} has no form in C",
            remedy=f"identify with terms that have one: {known}, without presliding",
        )
    return WRITERS[type(term)](term, joint, constants, dialect)


def _armature(term: Armature, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    return Expression("rotor", constants["Ia"])


def _coulomb(term: Coulomb, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    size = _by_direction("c0", joint, constants, dialect) if term.asymmetric else constants["c0"]
    return _dry(term, size, joint, dialect)


def _stribeck(term: Stribeck, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    ratio = f"(v[{joint}] / {dialect.number(number(term.velocity))})"
    return _dry(term, f"{constants['cs']} * {dialect.function('exp')}(-{ratio} * {ratio})", joint, dialect)


def _dry(term: DryFriction, size: str, joint: int, dialect: Dialect) -> Expression:
    """Write a size times the direction of motion, zero in the dead band."""
    x, zero = f"v[{joint}]", dialect.number(0.0)
    if (smoothing := number(term.smoothing)) > 0.0:
        direction = f"{dialect.function('tanh')}({x} / {dialect.number(smoothing)})"
    else:
        one, minus = dialect.number(1.0), dialect.number(-1.0)
        direction = f"({x} > {zero} ? {one} : {x} < {zero} ? {minus} : {x})"
    torque = f"{size} * {direction}"
    if term.dead_band > 0.0:
        torque = f"({dialect.function('fabs')}({x}) > {dialect.number(term.dead_band)} ? {torque} : {zero})"
    return Expression("friction", torque)


def _viscous(term: Viscous, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    rate = _by_direction("d", joint, constants, dialect) if term.asymmetric else constants["d"]
    return Expression("friction", f"{rate} * v[{joint}]")


def _by_direction(symbol: str, joint: int, constants: Mapping[str, str], dialect: Dialect) -> str:
    """Choose between forwards and backwards; zero where one of the two is part of another parameter."""
    zero = dialect.number(0.0)
    forwards, backwards = (constants.get(f"{symbol}{way}", zero) for way in "pn")
    return f"(v[{joint}] > {zero} ? {forwards} : {backwards})"


def _offset(term: Offset, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    return Expression("stiffness", constants["offset"])


def _stiffness(term: Stiffness, joint: int, constants: Mapping[str, str], dialect: Dialect) -> Expression:
    """Horner's scheme; a power whose parameter is part of another has none of its own."""
    text, x = constants.get(term.symbols[0], ""), f"q[{joint}]"
    for symbol in term.symbols[1:]:
        text = f"{f'({text})' if ' + ' in text else text} * {x}" if text else ""
        text = " + ".join(part for part in (text, constants.get(symbol, "")) if part)
    return Expression("stiffness", text)


WRITERS: Mapping[type[Term], Callable[..., Expression]] = {
    Armature: _armature,
    Coulomb: _coulomb,
    Offset: _offset,
    Stiffness: _stiffness,
    Stribeck: _stribeck,
    Viscous: _viscous,
}
"""Terms that have a form in C."""
