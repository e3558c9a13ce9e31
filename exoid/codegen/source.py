"""A leg written in C: text of the file, with the model and the values that it contains."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from exoid._typing import FloatArray
from exoid.tools.json_values import named
from exoid.tools.tables import to_text
from exoid.torques import TorqueModel

from .dialect import Dialect

SCHEMA = "exoid-c-1"

FUNCTIONS = ("gravity", "friction", "stiffness", "mass_matrix", "rigid_bodies", "inverse_dynamics")
"""Functions of every file, after the prefix."""

COMMAND = "command"
"""Function of a file with drives."""


@dataclass(frozen=True, eq=False, repr=False)
class CSource:
    """A leg written in C; prints itself.

    Attributes:
        text: Text of the file.
        prefix: Prefix of every name in the file.
        dialect: Precision of the numbers.
        model: Leg and terms that the functions compute.
        values: Parameters in the order of ``model.names``, (P,).
        warnings: Warnings about the values.
        path: File that contains the text; None if none was written.
        commands: Whether a function turns torques into commands of drives.
    """

    text: str
    prefix: str
    dialect: Dialect
    model: TorqueModel
    values: FloatArray
    warnings: tuple[str, ...] = ()
    path: Path | None = None
    commands: bool = False

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions in the file."""
        return tuple(f"{self.prefix}_{name}" for name in (*FUNCTIONS, *((COMMAND,) if self.commands else ())))

    @cached_property
    def sha256(self) -> str:
        """Hash of the file."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def to_json(self) -> dict[str, Any]:
        """Describe the file as JSON data.

        Returns:
            Name, hash, precision, functions, joints, values (SI), units, regrouped parameters and warnings.
        """
        names = self.model.names
        return {
            "schema": SCHEMA,
            "c": {"name": self.path.name if self.path else f"{self.prefix}.c", "sha256": self.sha256},
            "precision": self.dialect.real,
            "functions": list(self.functions),
            "joints": list(self.model.leg.joint_names),
            "values": named(names, self.values),
            "units": named(names, self.model.units),
            "merged": {regrouped.name: regrouped.into for regrouped in self.model.regrouped},
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        """Name the file and the precision."""
        return f"CSource({str(self.path or self.prefix)!r}, {self.dialect.real!r})"

    def __str__(self) -> str:
        """Print file, functions and usage."""
        where = self.path or f"{self.prefix}.c"
        joints = ", ".join(self.model.leg.joint_names)
        return to_text(
            f"{where}: {self.dialect.real} precision, C99, needs <math.h> only; joints in the order {joints}",
            f"functions: {', '.join(self.functions)}",
            f"to call them from another file: #define {self.prefix.upper()}_DECLARATIONS_ONLY, then #include it",
            *(f"warning: {warning}" for warning in self.warnings),
            *(f"note: {regrouped}" for regrouped in self.model.regrouped),
        )
