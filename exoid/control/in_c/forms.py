"""Forms of laws in C: a table that the laws of exoid and those of other packages register in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from exoid.codegen import Dialect
from exoid.codegen.laws import LawInC
from exoid.errors import ExoidError

L = TypeVar("L")
Form = Callable[[Any, Dialect], LawInC]

FORMS: dict[type[Any], Form] = {}
"""Types of law that have a form in C; :func:`register_law_in_c` adds to them."""


def register_law_in_c(kind: type[L]) -> Callable[[Callable[[L, Dialect], LawInC]], Callable[[L, Dialect], LawInC]]:
    """Register the form of a type of law in C: a decorator for the function that describes it.

    That function takes the law and the precision, which writes numbers and functions of <math.h>. It returns a
    :class:`exoid.codegen.laws.LawInC`.

    Args:
        kind: Type of the law. Subclasses need separate forms, as they may compute something else.

    Returns:
        The decorator, which leaves the function as it is. A later form of the same type replaces an earlier one.
    """

    def register(form: Callable[[L, Dialect], LawInC]) -> Callable[[L, Dialect], LawInC]:
        """Register the form of the type."""
        FORMS[kind] = form
        return form

    return register


def law_in_c(law: object, dialect: Dialect) -> LawInC:
    """Describe a law for C.

    Args:
        law: A law with or without memory.
        dialect: Precision.

    Returns:
        Its inputs, constants, memory and equation.

    Raises:
        ExoidError: Laws of this type have no form in C, or a term of the model has none.
    """
    if type(law) not in FORMS:
        raise ExoidError(
            f"{type(law).__name__} has no form in C",
            remedy=f"register one with exoid.control.in_c.register_law_in_c({type(law).__name__}), or use "
            f"{', '.join(sorted(kind.__name__ for kind in FORMS))}",
        )
    return FORMS[type(law)](law, dialect)
