"""Preparations by name, for files and the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar, overload

from exoid.errors import BadArgumentError
from exoid.tools.registry import Registry
from exoid.tools.settings import named_default, named_from_json, named_to_json, refuse_unwritable_class

from .preparation import FiniteDifference, MovingAverage, Preparation, Smoothed, ZeroPhase

KEY = "name"
"""Key of a preparation's name in files."""

Kind = TypeVar("Kind", bound=type[Preparation])


def _check(kind: type[Preparation]) -> None:
    """Refuse anything that is not a type of preparation."""
    if not isinstance(kind, type):
        raise BadArgumentError(f"{kind!r} is no class", remedy="pass the class of a preparation, not an object")
    refuse_unwritable_class(KEY, kind)
    members = ("name", "kinematics", "filter", "filter_columns", "parallel", "independent_fraction", "describe")
    missing = [member for member in members if member not in dir(kind)]
    if missing:
        raise BadArgumentError(
            f"the preparation {kind.__name__} lacks {', '.join(missing)}",
            remedy="add what exoid.signals.Preparation has, or derive it from a preparation of exoid",
        )


PREPARATIONS: Registry[type[Preparation]] = Registry(
    "preparation", "exoid.preparations", "exoid.signals.register_preparation", _check
)
"""Types of preparation by name: those of exoid, those that were registered, and those of installed packages."""


@overload
def register_preparation(name: str) -> Callable[[Kind], Kind]: ...


@overload
def register_preparation(name: str, kind: Kind) -> Kind: ...


def register_preparation(name: str, kind: Kind | None = None) -> Kind | Callable[[Kind], Kind]:
    """Give a type of preparation a name, for files and the command line.

    An estimate that was prepared by it can be saved. To load it, the name must be registered again. A package that
    offers the type as an entry point of the group ``exoid.preparations`` needs no call: exoid finds it where the
    package is installed.

    Args:
        name: Letters, digits, ".", "_" and "-", such as "median".
        kind: The type, a frozen dataclass with the members of :class:`Preparation`; None for a decorator. Settings that
            a file can hold are finite numbers, text, True, False, None and tuples of these.

    Returns:
        The type as it is, or the decorator.

    Raises:
        ExoidError: The name is taken or has another form, or a member is missing.

    Example:
        >>> from dataclasses import dataclass
        >>> @register_preparation("slow")
        ... @dataclass(frozen=True)
        ... class Slow(ZeroPhase):
        ...     '''Zero-phase filter with a low cut-off [Hz].'''
        ...     cutoff: float = 2.0
        ...     name = "slow"
        >>> preparation_by_name("slow")
        Slow(cutoff=2.0, kinematics_cutoff=None, order=4)
    """
    if kind is None:
        return lambda kind: register_preparation(name, kind)
    PREPARATIONS.register(name, kind)
    return kind


for _kind in (FiniteDifference, MovingAverage, Smoothed, ZeroPhase):
    PREPARATIONS.register(_kind.name, _kind)


def preparation_by_name(name: str) -> Preparation:
    """Make a preparation with its default settings."""
    return named_default(PREPARATIONS, name)


def preparation_to_json(preparation: Preparation) -> dict[str, Any]:
    """Describe a preparation by its name and settings, and by its module if that is not of exoid."""
    return named_to_json(PREPARATIONS, KEY, preparation)


def preparation_from_json(data: Mapping[str, Any]) -> Preparation:
    """Make a preparation from its description."""
    return named_from_json(PREPARATIONS, KEY, data)
