"""Terms by name, for files and the command line."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, overload

from exoid.errors import BadArgumentError
from exoid.tools.registry import Registry

from .couplings import CouplingFriction, CouplingInertia, CouplingSpring
from .friction import LoadFriction, Stribeck
from .term import Term
from .terms import Armature, Coulomb, Offset, Stiffness, Viscous

DEFAULT_TERMS: tuple[Term, ...] = (
    Coulomb(smoothing=0.015, reversal_speed=0.03),
    Viscous(),
    Armature(),
    Offset(),
)
"""Terms of a leg if the caller gives none. Leaving out an effect that exists costs far more accuracy than including one
that does not."""

Kind = TypeVar("Kind", bound=type[Term])


TERMS: Registry[Term] = Registry("term", "exoid.torques.register_term")
"""Types of term by name, for files and the command line: those of exoid, and those that were registered."""


@overload
def register_term(name: str) -> Callable[[Kind], Kind]: ...


@overload
def register_term(name: str, kind: Kind) -> Kind: ...


def register_term(name: str, kind: Kind | None = None) -> Kind | Callable[[Kind], Kind]:
    """Give a type of term a name, for files and the command line.

    An estimate with such a term can be saved. To load it, the name must be registered again.

    Args:
        name: Letters, digits, ".", "_" and "-", such as "end-stop".
        kind: The type, a frozen dataclass derived from :class:`Term`; None for a decorator. Settings that a file can
            hold are finite numbers, text, True, False, None and tuples of these.

    Returns:
        The type as it is, or the decorator.

    Raises:
        ExoidError: The name is taken or has another form, or the class is not a type of term.

    Example:
        >>> from dataclasses import dataclass
        >>> @register_term("drag")
        ... @dataclass(frozen=True, kw_only=True)
        ... class Drag(exoid.Viscous):
        ...     '''Drag of a fluid, τ = d |v| v.'''
        ...     def fill(self, motion, out):
        ...         out[0] = abs(motion.v) * motion.v
        >>> TERMS.from_json(TERMS.to_json(Drag(joints=("knee",))))
        Drag(joints=('knee',))
    """
    if kind is None:
        return lambda kind: register_term(name, kind)
    if not (isinstance(kind, type) and issubclass(kind, Term)):
        raise BadArgumentError(
            f"{kind!r} is no type of term", remedy="derive a frozen dataclass from exoid.torques.Term"
        )
    TERMS.register(name, kind)
    return kind


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
