"""A law written in C: header and source."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exoid.codegen.dialect import Dialect
from exoid.tools.tables import to_text

from .law_in_c import LawInC
from .safety import Safety

SCHEMA = "exoid-law-in-c-1"


@dataclass(frozen=True, eq=False, repr=False)
class LawSource:
    """A law written in C; prints itself.

    Attributes:
        header: Text of the header.
        source: Text of the source.
        prefix: Prefix of every name in the files.
        dialect: Precision of the numbers.
        law: The law.
        safety: Watchdog and safe torque.
        warnings: Warnings about the model.
        path: Source that was written; None if none was.
    """

    header: str
    source: str
    prefix: str
    dialect: Dialect
    law: LawInC
    safety: Safety
    warnings: tuple[str, ...] = ()
    path: Path | None = None

    @property
    def header_name(self) -> str:
        """Name of the header, which the source includes."""
        return f"{self.prefix}.h"

    @property
    def source_name(self) -> str:
        """Name of the source."""
        return self.path.name if self.path else f"{self.prefix}.c"

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions for other files."""
        return f"{self.prefix}_init", f"{self.prefix}_step"

    def to_json(self) -> dict[str, Any]:
        """Describe the files as JSON data.

        Returns:
            Names, hashes, equation, rate, precision, functions, joints, inputs, safe torque and warnings.
        """
        texts = {self.header_name: self.header, self.source_name: self.source}
        return {
            "schema": SCHEMA,
            "files": {name: hashlib.sha256(text.encode()).hexdigest() for name, text in texts.items()},
            "equation": self.law.equation,
            "rate": self.law.rate,
            "precision": self.dialect.real,
            "functions": list(self.functions),
            "joints": list(self.law.joints),
            "inputs": ["q", "v", *(each.name for each in self.law.inputs)],
            "safe": self.safety.safe,
            "patience": self.safety.patience,
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        """Name the file and the precision."""
        return f"LawSource({str(self.path or self.prefix)!r}, {self.dialect.real!r})"

    def __str__(self) -> str:
        """Print files, functions and inputs."""
        where = self.path or Path(f"{self.prefix}.c")
        return to_text(
            f"{where} and {where.with_name(self.header_name)}: {self.law.equation}",
            f"{self.dialect.real} precision, C99, needs <math.h> only; joints: {', '.join(self.law.joints)}",
            f"functions: {', '.join(self.functions)}, {self.law.rate:g} times a second",
            f"inputs: {', '.join(('q', 'v', *(each.name for each in self.law.inputs)))}",
            *(f"warning: {warning}" for warning in self.warnings),
        )
