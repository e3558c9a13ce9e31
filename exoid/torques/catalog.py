"""Terms by name, for files and the command line."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.model import joint_axis
from exoid.tools.registry import Registry

from .couplings import CouplingFriction, CouplingInertia, CouplingSpring
from .friction import LoadFriction, Stribeck
from .term import Term
from .terms import REVERSAL, SMOOTHING, Armature, Coulomb, DryFriction, Offset, Stiffness, Viscous

DEFAULT_TERMS: tuple[Term, ...] = (Coulomb(), Viscous(), Armature(), Offset())
"""Terms of a leg if the caller gives none. Leaving out an effect that exists costs far more accuracy than including one
that does not."""

SLIDE = 0.1
"""Length that counts as a radian at a prismatic joint [m], for settings and thresholds that nobody chose for it."""

TERMS: Registry[Term] = Registry("term", "exoid.torques.register_term")
"""Types of term by name, for files and the command line: those of exoid, and those that were registered."""


def turning_joints(leg: Leg) -> list[bool]:
    """Whether each joint of the equation is revolute; the others are prismatic."""
    turns = [bool(joint_axis(joint)[3:].any()) for joint in list(leg.model.joints)[1:]]
    return turns if leg.closure is None else [turns[j] for j in leg.closure.independent]


def radians(leg: Leg) -> FloatArray:
    """What counts as a radian at each joint of the equation, 1 rad or :data:`SLIDE`, (n,)."""
    return np.where(turning_joints(leg), 1.0, SLIDE)


def at_slide(term: Term) -> Term:
    """Dry friction of a prismatic joint, at which usual speeds are those of a radian."""
    usual = {"smoothing": SMOOTHING, "reversal_speed": REVERSAL, "velocity": Stribeck.velocity}
    found = {name: SLIDE * getattr(term, name) for name, x in usual.items() if getattr(term, name, None) == x}
    return replace(term, **found) if isinstance(term, DryFriction) else term


def terms_of(terms: Term | Iterable[Term] | None) -> tuple[Term, ...]:
    """Terms as a caller gives them, one or several; the default ones for None."""
    if terms is None:
        return DEFAULT_TERMS
    several = tuple(terms) if isinstance(terms, Iterable) and not isinstance(terms, str) else (terms,)
    wrong = [item for item in several if not isinstance(item, Term)]
    if wrong:
        remedy = "pass terms such as (exoid.Coulomb(), exoid.Viscous()), and a cut-off as cutoff="
        raise BadArgumentError(f"{wrong[0]!r} is no term", remedy=remedy)
    return several


def register_term(name: str, kind: type[Term]) -> None:
    """Give a type of term a name, for files and the command line.

    An estimate with such a term can be saved. To load it, the name must be registered again.

    Args:
        name: Letters, digits, ".", "_" and "-", such as "end-stop".
        kind: The type, a frozen dataclass derived from :class:`Term`. Settings that a file can hold are finite numbers,
            text, True, False, None and tuples of these.

    Raises:
        ExoidError: The name is taken or has another form, or the class is not a type of term.

    Example:
        >>> from dataclasses import dataclass
        >>> @dataclass(frozen=True, kw_only=True)
        ... class Drag(exoid.Viscous):
        ...     '''Drag of a fluid, τ = d |v| v.'''
        ...     def fill(self, motion, out):
        ...         out[0] = abs(motion.v) * motion.v
        >>> register_term("drag", Drag)
        >>> TERMS.from_json(TERMS.to_json(Drag(joints=("knee",))))
        Drag(joints=('knee',))
    """
    if not (isinstance(kind, type) and issubclass(kind, Term)):
        what = f"{kind!r} is no type of term"
        raise BadArgumentError(what, remedy="derive a frozen dataclass from exoid.torques.Term")
    TERMS.register(name, kind)


BUILT_IN: tuple[type[Term], ...] = (Armature, Coulomb, CouplingFriction, CouplingInertia, CouplingSpring, LoadFriction)
BUILT_IN += (Offset, Stiffness, Stribeck, Viscous)
for kind in BUILT_IN:
    register_term(re.sub("(?<=[a-z])(?=[A-Z])", "-", kind.__name__).lower(), kind)  # CouplingSpring: coupling-spring
