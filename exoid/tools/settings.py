"""Terms and preparations in files: by name and settings, exact to the last bit."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

from exoid.errors import BadArgumentError

from .registry import Registry

ORIGIN = "from"
"""Key of the module that a class from outside exoid comes from; no field of a class can have this name."""

T = TypeVar("T")


def refuse_unwritable_class(key: str, kind: type) -> None:
    """Check that objects of a class can be written by name and settings."""
    if not is_dataclass(kind):
        raise BadArgumentError(f"{kind.__name__} is no dataclass", remedy="decorate it with @dataclass(frozen=True)")
    if any(field.name == key for field in fields(kind)):
        raise BadArgumentError(
            f"{kind.__name__} has a field {key!r}", remedy=f"rename it: in files {key!r} has another use"
        )


def named_default(registry: Registry[type[T]], name: str) -> T:
    """Make an object of a named class with its default settings."""
    kind = registry.find(name)
    try:
        return kind()
    except TypeError as error:
        raise BadArgumentError(
            f"the {registry.what} {name!r} cannot be made without settings ({error})",
            remedy=f"pass {kind.__name__}(...) to exoid.identify in Python",
        ) from error


def named_to_json(registry: Registry[type[T]], key: str, thing: T) -> dict[str, Any]:
    """Describe an object by the name of its class, and by its settings."""
    kind = type(thing)
    name = registry.name_of(kind)
    if name is None:
        raise BadArgumentError(
            f"{kind.__name__} has no name in files",
            remedy=f'give it one: {registry.call}("name", {kind.__name__})',
        )
    origin = {} if kind.__module__.partition(".")[0] == "exoid" else {ORIGIN: kind.__module__}
    settings = {
        field.name: _value_to_json(getattr(thing, field.name), f"{kind.__name__}({field.name}=")
        for field in fields(thing)  # type: ignore[arg-type]
        if field.init
    }
    return {key: name, **origin, **settings}


def named_from_json(registry: Registry[type[T]], key: str, data: Mapping[str, Any]) -> T:
    """Make an object from its description."""
    name, origin = data.get(key, ""), str(data.get(ORIGIN, ""))
    kind = registry.find(name, origin)
    settings = {field: value for field, value in data.items() if field not in (key, ORIGIN)}
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
            f"the {registry.what} {name!r} does not take {settings} ({error})",
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
