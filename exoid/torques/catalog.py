"""Terms by name, for files and the command line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from exoid.errors import ExoidError

from .armature import Armature
from .coulomb import Coulomb
from .load_friction import LoadFriction
from .nonlinear import NonlinearParameter
from .offset import Offset
from .stiffness import Stiffness
from .stribeck import Stribeck
from .term import Term
from .viscous import Viscous

TERMS: Mapping[str, type[Term]] = {
    "armature": Armature,
    "coulomb": Coulomb,
    "load-friction": LoadFriction,
    "offset": Offset,
    "stiffness": Stiffness,
    "stribeck": Stribeck,
    "viscous": Viscous,
}

DEFAULT_TERMS: tuple[Term, ...] = (Coulomb(), Viscous(), Armature(), Offset())
"""What a leg is assumed to have where the caller does not say: leaving out an effect that exists costs far more
accuracy than including one that does not."""


def term_by_name(name: str) -> Term:
    """Make a term with its default settings.

    Raises:
        ExoidError: There is no such term.
    """
    if name not in TERMS:
        raise ExoidError(f"no term {name!r}", remedy=f"use some of {', '.join(TERMS)}")
    return TERMS[name]()


def term_to_json(term: Term) -> dict[str, Any]:
    """Describe a term by its name and settings.

    Raises:
        ExoidError: The term is not one of :data:`TERMS`.
    """
    names = [known for known, kind in TERMS.items() if type(term) is kind]
    if not names:
        raise ExoidError(f"{type(term).__name__} has no name in files", remedy=f"use some of {', '.join(TERMS)}")
    return {"term": names[0], **asdict(term)}


def term_from_json(data: Mapping[str, Any]) -> Term:
    """Make a term from its description.

    Raises:
        ExoidError: The description is of no known term.
    """
    try:
        return TERMS[data["term"]](**{key: _setting(value) for key, value in data.items() if key != "term"})
    except (KeyError, TypeError) as error:
        raise ExoidError(f"unknown term {dict(data)}", remedy=f"terms are {', '.join(TERMS)}") from error


def _setting(value: Any) -> Any:  # noqa: ANN401 - of many types
    if isinstance(value, Mapping):
        return NonlinearParameter(**value)
    return tuple(value) if isinstance(value, list) else value
