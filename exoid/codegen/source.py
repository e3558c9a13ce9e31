"""C that was written: its files, with what they compute."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exoid.tools.tables import to_text
from exoid.torques import TorqueModel

from .dialect import Dialect
from .law_in_c import LawInC


@dataclass(frozen=True, eq=False, repr=False)
class CSource:
    """A leg or a law written in C, alone or inside a package for ROS 2; prints itself.

    Attributes:
        files: Text of each file by its name, the C first, then its header if there is one.
        prefix: Prefix of every name in the files.
        dialect: Precision of the numbers.
        content: Leg and terms, or the law.
        functions: Names of the functions for other files.
        facts: Content as JSON data.
        summary: Lines that describe the content.
        warnings: Warnings about the model.
        path: C file or folder that was written; None if none was.
    """

    files: dict[str, str]
    prefix: str
    dialect: Dialect
    content: TorqueModel | LawInC
    functions: tuple[str, ...]
    facts: dict[str, Any]
    summary: tuple[str, ...]
    warnings: tuple[str, ...] = ()
    path: Path | None = None

    @property
    def text(self) -> str:
        """Text of the C."""
        return next(iter(self.files.values()))

    @property
    def header(self) -> str:
        """Text of the header of a law."""
        return self.files[f"{self.prefix}.h"]

    @property
    def sha256(self) -> str:
        """Hash of the C."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def to_json(self) -> dict[str, Any]:
        """Describe the files as JSON data.

        Returns:
            Names, hashes, precision, functions, joints, warnings, and the values of a leg or the settings of a law.
        """
        hashes = {name: hashlib.sha256(text.encode()).hexdigest() for name, text in self.files.items()}
        name = next(iter(hashes))
        files = {"c": {"name": name, "sha256": hashes[name]}} if len(hashes) == 1 else {"files": hashes}
        return {**self.facts, **files, "warnings": list(self.warnings)}

    def __repr__(self) -> str:
        """Name the file and the precision."""
        return f"CSource({str(self.path or self.prefix)!r}, {self.dialect.real!r})"

    def __str__(self) -> str:
        """Print files, functions and inputs."""
        source, *others = self.files
        where = str(self.path or source)
        if len(others) == 1:
            where += f" and {Path(where).with_name(others[0])}"
        return to_text(f"{where}: {self.summary[0]}", *self.summary[1:], *(f"warning: {x}" for x in self.warnings))
