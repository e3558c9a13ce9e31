"""Conversion of results to JSON types."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


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


def _fields(value: object) -> Sequence[str] | None:
    """Names of a record's fields; None for a value that is no record."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return [field.name for field in dataclasses.fields(value)]
    return getattr(value, "_fields", None) if isinstance(value, tuple) else None
