"""Forms of terms in C: a table that built-in terms and those of other packages register in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeVar, get_args

from exoid.errors import BadArgumentError, NotSupportedError
from exoid.torques import CouplingInertia, Term

from .dialect import Dialect

Place = Literal["friction", "stiffness", "rotor"]
"""Place of a term in the file: the function of v, the function of q, or the table of rotor inertias."""


@dataclass(frozen=True)
class JointInC:
    """Variable and constants of one joint, for the form of a term.

    Attributes:
        variable: Variable of the joint in C: its velocity ``v[j]`` [rad/s] where the place is "friction", its angle
            ``q[j]`` [rad] where it is "stiffness"; empty where it is "rotor", whose inertia is constant. For a
            :class:`exoid.torques.CoordinateTerm` it is the coordinate or its rate.
        parameters: Constant in C of each symbol of the term; symbols regrouped into other parameters are missing.
        dialect: Precision, which writes numbers and functions of <math.h>.
    """

    variable: str
    parameters: Mapping[str, str]
    dialect: Dialect

    def parameter(self, symbol: str) -> str:
        """Look up the constant of a parameter.

        Args:
            symbol: One of the term's symbols.

        Returns:
            The constant in C; zero for a parameter that is regrouped into others, which then contain its torque.
        """
        return self.parameters.get(symbol, self.number(0.0))

    def number(self, value: float) -> str:
        """Write a constant in the file's precision; see :meth:`Dialect.number`.

        Args:
            value: The constant.

        Returns:
            Literal such as ``0.1f``.

        Raises:
            ExoidError: It is not finite in this precision.
        """
        return self.dialect.number(value)

    def function(self, name: str) -> str:
        """Name a function of <math.h> in the file's precision; see :meth:`Dialect.function`.

        Args:
            name: Name of the function for double, such as ``tanh``.

        Returns:
            ``tanh`` in double, ``tanhf`` in float.
        """
        return self.dialect.function(name)


T = TypeVar("T", bound=Term)


class CForm(NamedTuple):
    """Form of a type of term in C."""

    place: Place  # place in the file
    write: Callable[[Any, JointInC], str]  # expression of a term at a joint


FORMS: dict[type[Term], CForm] = {}
"""Types of term that have a form in C; :func:`register_c_form` adds to them."""


def register_c_form(
    kind: type[T], place: Place
) -> Callable[[Callable[[T, JointInC], str]], Callable[[T, JointInC], str]]:
    """Register the form of a type of term in C: a decorator for the function that writes it.

    That function takes the term and a :class:`JointInC`. It returns one C99 expression: the torque of the term at the
    joint [N·m], or its inertia [kg·m²] where the place is "rotor". An inertia initialises a static table, so its
    expression calls no function.

    Args:
        kind: Type of the term. Subclasses need separate forms, as they may compute something else.
        place: "friction" for a torque that depends on velocity, "stiffness" for one that depends on the angle or on
            nothing, "rotor" for one that is an inertia times acceleration.

    Returns:
        The decorator, which leaves the function as it is. A later form of the same type replaces an earlier one.

    Raises:
        ExoidError: The place is none of the three.

    Example:
        >>> class Drag(exoid.Viscous):
        ...     '''Drag of a fluid, τ = d |v| v.'''
        ...     def fill(self, motion, out):
        ...         out[0] = abs(motion.v) * motion.v
        >>> @register_c_form(Drag, "friction")
        ... def drag(term, joint):
        ...     v = joint.variable
        ...     return f"{joint.parameter('d')} * {joint.function('fabs')}({v}) * {v}"
    """
    if place not in get_args(Place):
        raise BadArgumentError(f"no place {place!r} for a term in C", remedy=f"use {', '.join(get_args(Place))}")

    def register(write: Callable[[T, JointInC], str]) -> Callable[[T, JointInC], str]:
        """Register the form of the type."""
        FORMS[kind] = CForm(place, write)
        return write

    return register


def c_form(term: Term) -> CForm:
    """Look up the form of a term in C."""
    described = f"{type(term).__name__} ({', '.join(term.symbols)})"
    if term.loaded or term.internal_state is not None:
        needs = "depends on the load of its joint" if term.loaded else "has memory"
        raise NotSupportedError(
            f"{described} has no form in C: it {needs}, and the functions take one velocity or angle",
            remedy="identify with terms that depend on one of these alone, without presliding",
        )
    if isinstance(term, CouplingInertia):
        what = f"{described} has no form in C: it is an inertia of several joints together, and C has one of each joint"
        remedy = "take a law without inertia, such as gravity_friction_pd or gravity_support, or control from Python"
        raise NotSupportedError(what, remedy=remedy)
    if type(term) not in FORMS:
        raise NotSupportedError(
            f"{described} has no form in C",
            remedy=f"register one with exoid.codegen.register_c_form({type(term).__name__}, place), or identify with "
            f"terms that have one: {', '.join(kind.__name__ for kind in FORMS)}",
        )
    return FORMS[type(term)]
