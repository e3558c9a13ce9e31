"""Conversion of results to JSON types."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from types import UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

T = TypeVar("T")


def json_value(value: object) -> Any:  # noqa: ANN401 - of many types
    """Convert a value to JSON types."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    names = _fields(value)
    if names is not None:
        return attributes(value, *names)
    if isinstance(value, Mapping):
        return {key: json_value(each) for key, each in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [json_value(each) for each in value]
    if value is None or isinstance(value, str | int | float):
        return None if isinstance(value, float) and not math.isfinite(value) else value
    raise TypeError(f"no JSON for {type(value).__name__}")


def attributes(record: object, *names: str) -> dict[str, Any]:
    """Convert some attributes of a record with :func:`json_value`."""
    return {name: json_value(getattr(record, name)) for name in names}


def named(names: Sequence[str], values: object) -> dict[str, Any]:
    """Name the entries along the first axis, such as those of parameters or joints."""
    return dict(zip(names, json_value(values), strict=True))


def record(kind: type[T], data: Mapping[str, Any]) -> T:
    """Rebuild a dataclass or named tuple from what :func:`json_value` made of it, by the types of its fields."""
    hints = get_type_hints(kind)
    return kind(**{name: _of_type(hints[name], value) for name, value in data.items()})


def records(kind: type[T], data: Sequence[Mapping[str, Any]]) -> tuple[T, ...]:
    """Rebuild several records."""
    return tuple(record(kind, each) for each in data)


def _of_type(hint: Any, value: Any) -> Any:  # noqa: ANN401 - of many types
    """Convert a value of JSON to the type of a field; what does not fit raises TypeError, ValueError or LookupError."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return None if value is None else _of_type(inner[0], value)
    if origin is tuple:
        kinds = [inner[0]] * len(value) if inner[-1] is Ellipsis else inner
        return tuple(_of_type(each, entry) for each, entry in zip(kinds, value, strict=True))
    if origin is np.ndarray:
        return np.array(value, dtype=np.float64)
    if origin is Mapping:
        return {str(key): _of_type(inner[1], entry) for key, entry in value.items()}
    if hint not in (str, int, float, bool):
        return value if origin is Literal else record(hint, value)  # of a literal the record checks the value
    if type(value) is not hint and not (hint is float and type(value) is int):  # True and "8" are no numbers
        raise TypeError(f"{value!r} is no {hint.__name__}")
    return hint(value)


def _fields(value: object) -> Sequence[str] | None:
    """Names of a record's fields; None for a value that is no record."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return [field.name for field in dataclasses.fields(value)]
    return getattr(value, "_fields", None) if isinstance(value, tuple) else None
