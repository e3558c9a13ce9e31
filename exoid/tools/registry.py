"""Registries of terms, estimators, preparations and log formats, to which other packages can add."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar

from exoid.errors import BadArgumentError, ExoidError, nearest

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
"""Form of a name: it has no comma and no space, which separate names on the command line."""

T = TypeVar("T")


class EntryPoint(NamedTuple):
    """Entry point of an installed distribution."""

    target: str  # module and object, such as `exoid_springs:EndStop`
    distribution: str  # name and version of the distribution
    load: Callable[[], Any]  # function that imports the module and returns the object

    @property
    def package(self) -> str:
        """Top-level package of the target."""
        return _package(self.target)


class Registry(Mapping[str, T], Generic[T]):
    """Objects by name: those of exoid, those registered by a call, and the entry points of installed distributions."""

    # Metadata of distributions are read once, when a name is unknown or all names are needed. A module is imported only
    # when one of its objects is requested. A registered name has precedence over an entry point of the same name.

    def __init__(self, what: str, group: str, call: str, check: Callable[[T], None]) -> None:
        self.what = what
        self.group = group
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
        if isinstance(name, str) and name in self._registered:
            return self._registered[name]
        if name in self:
            return self._load(name)
        source = f" (the file has it from the module {origin})" if origin else ""
        some = f"{nearest(name, self)}use some of {', '.join(self)}; or install the package that provides it"
        raise BadArgumentError(
            f"no {self.what} {name!r}{source}",
            remedy=f"{some}, or import it and call {self.call}({name!r}, ...)",
            command=some,
        )

    def name_of(self, thing: T) -> str | None:
        """Find the name of an object."""
        registered = self._name_of_registered(thing)
        if registered is None:
            home = _package(getattr(thing, "__module__", None) or "")
            for name in [name for name, offers in self._offers.items() if any(o.package == home for o in offers)]:
                self.find(name)
            registered = self._name_of_registered(thing)
        return registered

    @property
    def registered(self) -> tuple[str, ...]:
        """Registered names without those of entry points, sorted."""
        return tuple(sorted(self._registered))

    def __getitem__(self, name: str) -> T:
        if name not in self:
            raise KeyError(name)
        return self.find(name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (name in self._registered or name in self._offers)

    def __iter__(self) -> Iterator[str]:
        return iter(sorted({*self._registered, *self._offers}))

    def __len__(self) -> int:
        return len({*self._registered, *self._offers})

    def __repr__(self) -> str:
        return f"<{self.what}s: {', '.join(self)}>"

    @cached_property
    def _offers(self) -> dict[str, list[EntryPoint]]:
        """Entry points of installed distributions, by name."""
        from importlib.metadata import entry_points  # noqa: PLC0415 - takes 25 ms and is rarely needed

        offers: dict[str, list[EntryPoint]] = {}
        for found in entry_points(group=self.group):
            dist = found.dist
            distribution = "an unknown distribution" if dist is None else f"{dist.name} {dist.version}"
            offers.setdefault(found.name, []).append(EntryPoint(found.value, distribution, found.load))
        return offers

    def _load(self, name: str) -> T:
        """Load an entry point, and register its object."""
        offer, *others = self._offers[name]
        rivals = [other.distribution for other in others if other.target != offer.target]
        if rivals:
            raise BadArgumentError(
                f"the {self.what} {name!r} is offered by {offer.distribution} and by {', '.join(rivals)}",
                remedy="uninstall all but one",
            )
        try:
            return self.register(name, offer.load())
        except (Exception, SystemExit) as error:  # any error of the package's code
            why = error.what if isinstance(error, ExoidError) else f"{type(error).__name__}: {error}"
            raise BadArgumentError(
                f"the {self.what} {name!r} of {offer.distribution} ({offer.target}) cannot be loaded: {why}",
                remedy=f"mend or uninstall {offer.distribution.split()[0]}",
            ) from error

    def _name_of_registered(self, thing: T) -> str | None:
        return next((name for name, known in self._registered.items() if known is thing), None)


def _package(path: str) -> str:
    """Top-level package of a module or of an object in it."""
    return path.partition(":")[0].partition(".")[0].strip()


def _redefined(known: object, thing: object) -> bool:
    """Tell whether a class or function is a new definition of another one."""
    places = [(getattr(x, "__module__", None), getattr(x, "__qualname__", "<none>")) for x in (known, thing)]
    return places[0] == places[1] and "<" not in places[0][1]


def _described(thing: object) -> str:
    """Name a class or function with its module; any other object by its representation."""
    name = getattr(thing, "__qualname__", None)
    return repr(thing) if name is None else f"{thing.__module__}.{name}"
