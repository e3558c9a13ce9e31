"""A leg written in C: the text, and what it computes."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from exoid._typing import FloatArray
from exoid.tables import to_text
from exoid.torques import TorqueModel

from .dialect import Dialect

SCHEMA = "exoid-c-1"

FUNCTIONS = ("gravity", "friction", "stiffness", "mass_matrix", "rigid_bodies", "inverse_dynamics")
"""What every file has, after the prefix."""


@dataclass(frozen=True, eq=False, repr=False)
class CSource:
    """A leg written in C; prints itself.

    Attributes:
        text: Text of the file.
        prefix: Prefix of every name in it.
        dialect: Precision of its numbers.
        model: Leg and terms that it computes.
        values: Parameters in the order of ``model.names``, (P,).
        warnings: What makes the values doubtful.
        path: Where it was written; None where it was not.
    """

    text: str
    prefix: str
    dialect: Dialect
    model: TorqueModel
    values: FloatArray
    warnings: tuple[str, ...] = ()
    path: Path | None = None

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of its functions."""
        return tuple(f"{self.prefix}_{name}" for name in FUNCTIONS)

    @cached_property
    def sha256(self) -> str:
        """Hash of the file."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def __repr__(self) -> str:
        """Name the file and the precision."""
        return f"CSource({str(self.path or self.prefix)!r}, {self.dialect.real!r})"

    def __str__(self) -> str:
        """Say what is in it and how to use it."""
        where = self.path or f"{self.prefix}.c"
        joints = ", ".join(self.model.leg.joint_names)
        return to_text(
            f"{where}: {self.dialect.real} precision, C99, needs <math.h> only; joints in the order {joints}",
            f"functions: {', '.join(self.functions)}",
            f"to call them from another file: #define {self.prefix.upper()}_DECLARATIONS_ONLY, then #include it",
            *(f"warning: {warning}" for warning in self.warnings),
            *(f"note: {regrouped}" for regrouped in self.model.regrouped),
        )


def c_source_to_json(source: CSource) -> dict[str, Any]:
    """Describe a C file as JSON data.

    Args:
        source: The file.

    Returns:
        Its name, hash, precision and functions, and joints, values (SI), units, regrouped parameters and warnings.
    """
    model, names = source.model, source.model.names
    return {
        "schema": SCHEMA,
        "c": {"name": source.path.name if source.path else f"{source.prefix}.c", "sha256": source.sha256},
        "precision": source.dialect.real,
        "functions": list(source.functions),
        "joints": list(model.leg.joint_names),
        "values": dict(zip(names, source.values.tolist(), strict=True)),
        "units": dict(zip(names, model.units, strict=True)),
        "merged": {regrouped.name: regrouped.into for regrouped in model.regrouped},
        "warnings": list(source.warnings),
    }
