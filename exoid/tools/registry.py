"""Classes by name, to which other packages can add, and their objects in files: by name and settings."""

from __future__ import annotations

import math
import re
import reprlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Generic, TypeVar

from exoid.errors import BadArgumentError, nearest

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
"""Form of a name: it has no comma and no space, which separate names on the command line."""

ORIGIN = "from"
"""Key of the module that a class from outside exoid comes from; no field of a class can have this name."""

T = TypeVar("T")


class Registry(Generic[T]):
    """Dataclasses by name: those of exoid, and those registered by a call.

    In files, the key of the name is what the classes are, such as "term".
    """

    def __init__(self, what: str, call: str) -> None:
        self.what = what
        self.call = call
        self.classes: dict[str, type[T]] = {}

    def register(self, name: str, kind: type[T]) -> None:
        """Give a class a name; refuse one whose objects could not be written by it."""
        if not isinstance(name, str) or not NAME.fullmatch(name):
            remedy = f'write {self.call}("name", ...) with letters, digits, ".", "_" and "-"'
            raise BadArgumentError(f"{name!r} is no name for a {self.what}", remedy=remedy)
        if not is_dataclass(kind):
            raise BadArgumentError(
                f"{kind.__name__} is no dataclass", remedy="decorate it with @dataclass(frozen=True)"
            )
        if any(field.name == self.what for field in fields(kind)):
            remedy = f"rename it: in files {self.what!r} has another use"
            raise BadArgumentError(f"{kind.__name__} has a field {self.what!r}", remedy=remedy)
        known = self.classes.get(name, kind)
        known_place, place = ((some.__module__, some.__qualname__) for some in (known, kind))
        redefined = known_place == place and "<" not in kind.__qualname__  # as in a notebook whose cell runs twice
        if known is not kind and not redefined:
            what = f"the {self.what} {name!r} exists: {known.__module__}.{known.__qualname__}"
            raise BadArgumentError(what, remedy=f"give {kind.__module__}.{kind.__qualname__} another name")
        self.classes[name] = kind

    def find(self, name: str, origin: str = "") -> type[T]:
        """Look up a class; a file tells its module."""
        if isinstance(name, str) and name in self.classes:
            return self.classes[name]
        source = f" (the file has it from the module {origin})" if origin else ""
        some = f"{nearest(name, self.classes)}use some of {', '.join(sorted(self.classes))}"
        raise BadArgumentError(
            f"no {self.what} {name!r}{source}",
            remedy=f"{some}, or import it and call {self.call}({name!r}, ...)",
            command=some,
        )

    def default(self, name: str) -> T:
        """Make an object of a class with its default settings."""
        kind = self.find(name)
        try:
            return kind()
        except TypeError as error:
            what = f"the {self.what} {name!r} cannot be made without settings ({error})"
            raise BadArgumentError(what, remedy=f"pass {kind.__name__}(...) to exoid.identify in Python") from error

    def to_json(self, thing: T) -> dict[str, Any]:
        """Describe an object by the name of its class, by its module if that is not of exoid, and by its settings."""
        kind = type(thing)
        name = next((name for name, known in self.classes.items() if known is kind), None)
        if name is None:
            remedy = f'give it one: {self.call}("name", {kind.__name__})'
            raise BadArgumentError(f"{kind.__name__} has no name in files", remedy=remedy)
        origin = {} if kind.__module__.partition(".")[0] == "exoid" else {ORIGIN: kind.__module__}
        settings = {
            field.name: _value_to_json(getattr(thing, field.name), f"{kind.__name__}({field.name}=")
            for field in fields(thing)  # type: ignore[arg-type]
            if field.init
        }
        return {self.what: name, **origin, **settings}

    def from_json(self, data: Mapping[str, Any]) -> T:
        """Make an object from its description."""
        name, origin = data.get(self.what, ""), str(data.get(ORIGIN, ""))
        kind = self.find(name, origin)
        settings = {field: value for field, value in data.items() if field not in (self.what, ORIGIN)}
        try:
            for field in fields(kind):  # type: ignore[arg-type]
                value = settings.get(field.name, 0.0)
                if field.type in (int, float, "int", "float") and type(value) not in (int, float):
                    raise TypeError(f"{field.name} is no number")
            return kind(**{field: _value_from_json(value) for field, value in settings.items()})
        except TypeError as error:
            known = ", ".join(field.name for field in fields(kind) if field.init) or "none"  # type: ignore[arg-type]
            version = f"; install the version of {origin} that wrote the file" if origin else ""
            raise BadArgumentError(
                f"the {self.what} {name!r} does not take {settings} ({error})",
                remedy=f"its settings are {known}{version}",
            ) from error


def _value_to_json(value: Any, where: str) -> Any:  # noqa: ANN401
    """Value of a field; numbers of NumPy are Python's only where they are the same type, as float64 is."""
    if type(value) is tuple:
        return [_value_to_json(item, where) for item in value]
    if isinstance(value, float) and math.isfinite(value):
        return float(value)
    if (
        value is None
        or type(value) in (bool, int)
        or (type(value) is str and value.encode(errors="ignore").decode() == value)
    ):
        return value
    raise BadArgumentError(
        f"{where}{reprlib.repr(value)}) cannot be written to a file",
        remedy="let settings be finite numbers, text, True, False, None, or tuples of these",
    )


def _value_from_json(value: Any) -> Any:  # noqa: ANN401
    return tuple(_value_from_json(item) for item in value) if isinstance(value, list) else value
