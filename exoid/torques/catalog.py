"""Terms by name, for files and the command line."""

from __future__ import annotations

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

TERMS: Registry[Term] = Registry("term", "exoid.torques.register_term")
"""Types of term by name, for files and the command line: those of exoid, and those that were registered."""


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
