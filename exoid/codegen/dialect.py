"""How numbers, functions and names are written in C."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from exoid.errors import BadArgumentError, NotSupportedError

ABSURD = 1e9
"""Size from which an input or a torque is absurd in any unit; it also stands for a limit that was not given."""

PRECISIONS = ("double", "float")
"""Types of number that a leg can be written in."""

IN_C = str.maketrans({"·": " ", "²": "^2", "³": "^3", "±": "+-", "×": "x", "÷": "/", "−": "-", "–": "-", "°": " deg"})
"""Characters of exoid's texts that are not ASCII."""


@dataclass(frozen=True)
class Dialect:
    """C99 in one precision.

    Attributes:
        real: "double" or "float".

    Raises:
        ExoidError: It is neither.

    Example:
        >>> Dialect("float").number(0.1), Dialect("double").number(2)
        ('0.1f', '2.0')
    """

    real: str = "double"

    def __post_init__(self) -> None:
        """Check the precision."""
        if self.real not in PRECISIONS:
            raise BadArgumentError(f"no precision {self.real!r}", remedy=f"use {' or '.join(PRECISIONS)}")

    def number(self, value: float) -> str:
        """Write a constant so that the compiler reads the same bits.

        Args:
            value: The constant.

        Returns:
            Literal of this precision, such as ``0.1f``.

        Raises:
            ExoidError: It is not finite in this precision.
        """
        if not math.isfinite(value):
            raise BadArgumentError(f"C has no number {value}", remedy="give every parameter and setting a finite value")
        if self.real == "double":
            return repr(float(value))  # the shortest text that reads back to the same bits
        with np.errstate(over="ignore"):
            narrow = np.float32(value)
        if not np.isfinite(narrow):
            raise BadArgumentError(f"{value:g} is too large for a float", remedy="write the leg in double precision")
        text = str(narrow)
        return f"{text if '.' in text or 'e' in text else f'{text}.0'}f"

    def function(self, name: str) -> str:
        """Name a function of <math.h> in this precision.

        Args:
            name: Name of the function for double, such as ``sin``.

        Returns:
            ``sin`` in double, ``sinf`` in float.
        """
        return name if self.real == "double" else f"{name}f"

    def require_double(self, what: str) -> None:
        """Refuse single precision.

        Args:
            what: What is too coarse in it.

        Raises:
            ExoidError: The precision is single.
        """
        if self.real != "double":
            raise NotSupportedError(f"{what} in single precision", remedy='use precision="double"')


def identifier(path: str | Path) -> str:
    """Turn a file's name into the prefix of the names in it."""
    stem = re.sub(r"[^A-Za-z0-9]+", "_", Path(path).name.removesuffix(".c")).strip("_")
    if not stem:
        raise BadArgumentError(
            f"{str(path)!r} is no name for C", remedy="give a file such as leg.c, or a name of letters"
        )
    return f"leg_{stem}" if stem[0].isdigit() else stem


def comment(text: str) -> str:
    """Make any text fit for a comment: one line of ASCII that neither ends nor starts a comment."""
    plain = " ".join(text.translate(IN_C).encode("ascii", "replace").decode().split())
    plain = " " * (len(text) - len(text.lstrip(" "))) + "".join(letter for letter in plain if letter.isprintable())
    # "??/" is a trigraph for a backslash, and a backslash at the end of a line would join the next one to the comment
    for forbidden, harmless in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?"), ("\\", "|")):
        while forbidden in plain:  # what is put in may form another one with its neighbours
            plain = plain.replace(forbidden, harmless)
    return plain
