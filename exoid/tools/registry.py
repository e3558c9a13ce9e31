"""Registries of terms and estimators, to which other packages can add."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Generic, TypeVar

from exoid.errors import BadArgumentError, nearest

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
"""Form of a name: it has no comma and no space, which separate names on the command line."""

T = TypeVar("T")


class Registry(Mapping[str, T], Generic[T]):
    """Objects by name: those of exoid, and those registered by a call."""

    def __init__(self, what: str, call: str, check: Callable[[T], None]) -> None:
        self.what = what
        self.call = call
        self._check = check
        self._registered: dict[str, T] = {}

    def register(self, name: str, thing: T) -> T:
        """Register an object under a name."""
        if not isinstance(name, str) or not NAME.fullmatch(name):
            remedy = f'write {self.call}("name", ...) with letters, digits, ".", "_" and "-"'
            raise BadArgumentError(f"{name!r} is no name for a {self.what}", remedy=remedy)
        self._check(thing)
        known = self._registered.get(name)
        if known is not None and known is not thing and not _redefined(known, thing):
            what = f"the {self.what} {name!r} exists: {_described(known)}"
            raise BadArgumentError(what, remedy=f"give {_described(thing)} another name")
        self._registered[name] = thing
        return thing

    def find(self, name: str, origin: str = "") -> T:
        """Look up an object."""
        if name in self:
            return self._registered[name]
        source = f" (the file has it from the module {origin})" if origin else ""
        some = f"{nearest(name, self)}use some of {', '.join(self)}"
        raise BadArgumentError(
            f"no {self.what} {name!r}{source}",
            remedy=f"{some}, or import it and call {self.call}({name!r}, ...)",
            command=some,
        )

    def name_of(self, thing: T) -> str | None:
        """Find the name of an object."""
        return next((name for name, known in self._registered.items() if known is thing), None)

    def __getitem__(self, name: str) -> T:
        return self._registered[name]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._registered

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._registered))

    def __len__(self) -> int:
        return len(self._registered)

    def __repr__(self) -> str:
        return f"<{self.what}s: {', '.join(self)}>"


def _redefined(known: object, thing: object) -> bool:
    """Tell whether a class or function is a new definition of another one."""
    places = [(getattr(x, "__module__", None), getattr(x, "__qualname__", "<none>")) for x in (known, thing)]
    return places[0] == places[1] and "<" not in places[0][1]


def _described(thing: object) -> str:
    """Name a class or function with its module; any other object by its representation."""
    name = getattr(thing, "__qualname__", None)
    return repr(thing) if name is None else f"{thing.__module__}.{name}"
