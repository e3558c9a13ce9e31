"""Terms by name, for files and the command line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.model import joint_axis
from exoid.tools.registry import Registry

from .couplings import CouplingFriction, CouplingInertia, CouplingSpring
from .friction import LoadFriction, Stribeck
from .term import Term
from .terms import Armature, Coulomb, Offset, Stiffness, Viscous

USUAL = Coulomb(smoothing=0.015, reversal_speed=0.03)
"""Dry friction of a revolute joint, in the default terms."""

DEFAULT_TERMS: tuple[Term, ...] = (USUAL, Viscous(), Armature(), Offset())
"""Terms of a leg if the caller gives none. Leaving out an effect that exists costs far more accuracy than including one
that does not."""

SLIDE = 0.1
"""Speed of a prismatic joint at which its default friction is as that of a revolute joint at 1 rad/s [m/s]."""

TERMS: Registry[Term] = Registry("term", "exoid.torques.register_term")
"""Types of term by name, for files and the command line: those of exoid, and those that were registered."""


def turning_joints(leg: Leg) -> list[bool]:
    """Whether each joint of the equation is revolute; the others are prismatic."""
    turns = [bool(joint_axis(joint)[3:].any()) for joint in list(leg.model.joints)[1:]]
    return turns if leg.closure is None else [turns[j] for j in leg.closure.independent]


def terms_of(leg: Leg, terms: Sequence[Term] | None) -> tuple[Term, ...]:
    """Terms as a caller gives them, one or several; those of the leg by default, by the kinds of its joints."""
    if terms is not None:
        return (terms,) if isinstance(terms, (Term, str)) else tuple(terms)
    named = list(zip(leg.joint_names, turning_joints(leg), strict=True))
    slides = tuple(name for name, turns in named if not turns)
    if not slides:
        return DEFAULT_TERMS
    slow = Coulomb(joints=slides, smoothing=SLIDE * USUAL.smoothing, reversal_speed=SLIDE * USUAL.reversal_speed)
    turning = replace(USUAL, joints=tuple(name for name, turns in named if turns))
    return (turning, slow, *DEFAULT_TERMS[1:])


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
        raise BadArgumentError(
            f"{kind!r} is no type of term", remedy="derive a frozen dataclass from exoid.torques.Term"
        )
    TERMS.register(name, kind)


register_term("armature", Armature)
register_term("coulomb", Coulomb)
register_term("coupling-friction", CouplingFriction)
register_term("coupling-inertia", CouplingInertia)
register_term("coupling-spring", CouplingSpring)
register_term("load-friction", LoadFriction)
register_term("offset", Offset)
register_term("stiffness", Stiffness)
register_term("stribeck", Stribeck)
register_term("viscous", Viscous)
