"""Description of a law with a model for :mod:`exoid.codegen`, which writes its C."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import ArrayInC, Dialect, InputInC, LawInC
from exoid.codegen.forms import c_form
from exoid.codegen.law_in_c import LegInC, Needed
from exoid.codegen.terms import torques_in_c
from exoid.errors import NotSupportedError
from exoid.torques import Coulomb, CouplingInertia, Stiffness, Term, Viscous
from exoid.torques.term import TermBlock

from .friction import FrictionCompensation
from .model import ControlModel, default_gains


def describe(
    model: ControlModel,
    friction: FrictionCompensation | None,
    rate: float,
    dialect: Dialect,
    *,
    equation: str,
    step: str,
    calls: tuple[Needed, ...],
    inputs: tuple[InputInC, ...] = (),
    tables: Mapping[str, tuple[FloatArray | float, str]],
    memory: Mapping[str, str] | None = None,
    begin: str = "",
    damping: FloatArray | None = None,
    measured: str = "in->v",
) -> LawInC:
    """Describe a law with a model: numbers and comment of each table, comment of the memory, which begins with zero."""
    # `{friction}` stands in the equation, and `{{friction}}` in the step, where friction is compensated, at the
    # velocity `measured`. The default damping of the safe torque is the default Kd of controllers, at the zero pose;
    # of an estimate that no links have it may be negative, and would drive.
    none = "    for (j = 0; j < {{N}}; ++j) {\n        friction[j] = {{number(0)}};\n    }"
    statements, words = (none, "") if friction is None else friction.in_c(measured)
    return LawInC(
        model.leg.joint_names,
        equation.replace("{friction}", words),
        step.replace("{{friction}}", statements),
        rate,
        default_gains(model, np.zeros(model.n), rate)[1].clip(0.0) if damping is None else damping,
        inputs,
        tuple(ArrayInC(name, what, np.array(values, dtype=np.float64)) for name, (values, what) in tables.items()),
        tuple(ArrayInC(name, what, np.zeros(model.n)) for name, what in (memory or {}).items()),
        begin,
        leg=_leg_in_c(model, calls, friction, dialect),
        limit=model.driven(np.full(model.n, np.inf)),
    )


def _leg_in_c(
    model: ControlModel, calls: tuple[Needed, ...], friction: FrictionCompensation | None, dialect: Dialect
) -> LegInC:
    """Write the springs, friction and rotors of a model as sums of terms, with the functions that a law calls."""
    places: dict[str, list[list[str]]] = {place: [[] for _ in range(model.n)] for place in ("stiffness", "friction")}
    places["rotor"] = [[dialect.number(inertia)] for inertia in model.armature.tolist()]
    still = np.zeros((model.n, 1))
    # rotors that several joints turn have no form, and no part in a law without inertia
    moving = bool({"inverse_dynamics", "bodies"} & {*calls})
    others = [other for other in model.others if moving or not isinstance(other.term, CouplingInertia)]
    for other in others:  # what a model has at rest counts as a spring
        if c_form(other.term).place == "friction" and other.torque(still, still, still, still).any():
            what = f"{type(other.term).__name__} has a torque at rest, which laws in C do not have"
            raise NotSupportedError(what, remedy='write its form with the place "stiffness", or as two terms')
    plain = _plain_terms(model, None if friction is None else friction.width)
    for term, joints, values in (*plain, *((other.term, other.joints, other.values) for other in others)):
        place = c_form(term).place
        scale = 1.0 if place != "friction" else 0.0 if friction is None else friction.scale
        numbers = zip(term.symbols, (scale * values).tolist(), strict=True)
        # in parentheses where negative, so that an operator may stand before it
        parameters = {
            symbol: dialect.number(value) if value >= 0.0 else f"({dialect.number(value)})"
            for symbol, value in numbers
            if not np.isnan(value)
        }
        for joint, expression in torques_in_c(TermBlock(term, joints, ()), parameters, dialect):
            places[place][joint].append(expression)
    zero = dialect.number(0.0)
    springs, sliding, rotors = (
        tuple(" + ".join(filter(None, parts)) or zero for parts in places[place])
        for place in ("stiffness", "friction", "rotor")
    )
    return LegInC(model.leg, springs, sliding, rotors, calls if friction is None else (*calls, "friction"))


def _plain_terms(model: ControlModel, width: float | None) -> Iterator[tuple[Term, tuple[int, ...], FloatArray]]:
    """Springs and plain friction of a model as terms; NaN where a spring has no coefficient of so high a power."""
    degree = max(1, len(model.spring) - 1)
    for j in range(model.n):
        powers = np.zeros(degree + 1)
        powers[degree + 1 - len(model.spring) :] = model.spring[:, j]
        powers[: np.argmax(np.append(powers, 1.0) != 0.0)] = np.nan
        yield Stiffness(degree=degree), (j,), powers
        if width is not None and model.coulomb[j] != 0.0:
            yield Coulomb(smoothing=width * float(model.radian[j])), (j,), model.coulomb[[j]]
        if width is not None and model.viscous[j] != 0.0:
            yield Viscous(), (j,), model.viscous[[j]]
