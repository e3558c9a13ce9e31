"""Arrays of constants in C, of any dimension."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .dialect import Dialect


def initializer(values: NDArray[Any], dialect: Dialect, indent: str = "") -> str:
    """Write the initializer of an array."""
    if values.ndim == 0:
        return str(int(values)) if np.issubdtype(values.dtype, np.integer) else dialect.number(float(values))
    if values.ndim == 1:
        return "{" + ", ".join(initializer(value, dialect) for value in values) + "}"
    inner = f"{indent}    "
    rows = ",\n".join(f"{inner}{initializer(row, dialect, inner)}" for row in values)
    return f"{{\n{rows}\n{indent}}}"
