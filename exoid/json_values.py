"""Results as JSON can hold them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def json_value(value: object) -> Any:  # noqa: ANN401 - of many types
    """Turn a value into what JSON can hold.

    Args:
        value: Text, a number, None, an array of any shape; or a sequence, mapping, dataclass or named tuple of such,
            nested in any way.

    Returns:
        Lists for arrays and sequences, dictionaries for mappings and for records by field. A number that is not finite,
        which JSON does not know, becomes None.

    Raises:
        TypeError: The value is of another kind.
    """
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
    """Take some attributes of a record, each as :func:`json_value` has it.

    Args:
        record: Any object.
        names: Attributes, in the order of the result.

    Returns:
        Values by name.
    """
    return {name: json_value(getattr(record, name)) for name in names}


def named(names: Sequence[str], values: object) -> dict[str, Any]:
    """Give each entry along the first axis its name, as for parameters and joints.

    Args:
        names: One an entry.
        values: An array or a sequence.

    Returns:
        Entries by name, each as :func:`json_value` has it.

    Raises:
        ValueError: There are more names than entries, or fewer.
    """
    return dict(zip(names, json_value(values), strict=True))


def _fields(value: object) -> Sequence[str] | None:
    """Names of a record's fields; None for what is no record."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return [field.name for field in dataclasses.fields(value)]
    return getattr(value, "_fields", None) if isinstance(value, tuple) else None
