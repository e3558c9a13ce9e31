"""Column of a log: its header in the file, with scale, zero and unit."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, ExoidError

from .quantities import is_unit, refuse_other_unit, zero_of

SYNTAX = "write NAME=HEADER, NAME=HEADER:SCALE, NAME=HEADER:SCALE:ZERO, and :UNIT behind them"


@dataclass(frozen=True)
class Column:
    """Column of a file that is read as scale · (cell − zero), in a unit.

    Attributes:
        header: Header in the file.
        scale: Unit of the result per unit of the cells. A negative scale changes the sign.
        zero: Value of the cell that stands for zero.
        unit: Unit of scale · (cell − zero), such as "mA", "N·mm", "deg/s" or "ms"; None for SI, or for degrees where
            ``angle_unit="deg"`` says so.

    Raises:
        ExoidError: Scale or zero is not a finite number, or the scale is zero.

    Example:
        >>> Column("current", scale=0.118).read("tau_hip", np.array([0.0, 10.0]))
        array([0.  , 1.18])
    """

    header: str
    scale: float = 1.0
    zero: float = 0.0
    unit: str | None = None
    _text: str = field(default="", repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("scale", "zero"):
            value = getattr(self, name)
            if not isinstance(value, float | int | np.number) or not math.isfinite(value):
                raise BadArgumentError(f"{name} of column {self.header!r} is {value!r}", remedy="pass a finite number")
        if self.scale == 0.0:
            raise BadArgumentError(
                f"scale of column {self.header!r} is zero", remedy="pass SI units per unit of the cells"
            )

    @staticmethod
    def from_text(text: str) -> Column:
        """Read ``HEADER[:SCALE[:ZERO]][:UNIT]``, as the command line writes it.

        A header may contain colons: the longest part of the text that is a header of the file counts as header.

        Args:
            text: The text.

        Returns:
            The column.

        Raises:
            ExoidError: A part behind the header is neither a number nor a unit.
        """
        header, *parts = text.split(":")
        try:
            return replace(_behind(header.strip(), parts, text), _text=text)
        except ExoidError:  # the file may have this very header
            return Column(text, _text=text)

    def read(self, name: str, cells: FloatArray) -> FloatArray:
        """Convert cells to scale · (cell − zero) in SI, or in the unit of the file where the column has none.

        Args:
            name: Name of the exoid column, such as "tau_hip".
            cells: Cells of the file, (N,).

        Returns:
            Values, (N,).

        Raises:
            ExoidError: The unit does not belong to the quantity.
        """
        factor = 1.0 if self.unit is None else refuse_other_unit(self.unit, name)
        readings = self.scale * (cells - self.zero)
        return np.asarray(factor * (readings if self.unit is None else readings - zero_of(self.unit)))

    @property
    def is_plain(self) -> bool:
        """Whether cells are taken as they are."""
        return self.unit is None and self.scale == 1.0 and self.zero == 0.0


def header_in(headers: Collection[str], text: str) -> str:
    """Find the longest beginning of ``HEADER:SCALE:ZERO:UNIT`` that is a header, as headers may contain colons."""
    beginning = text
    while beginning not in headers and ":" in beginning:
        beginning = beginning.rpartition(":")[0]
    return beginning if beginning in headers else text


def column_in(headers: Collection[str], column: str | Column, name: str) -> Column:
    """Take a header as it is, or find the column of a file that a text of the command line means."""
    if isinstance(column, str):
        return Column(column)
    header = header_in(headers, column._text)
    if not column._text or header not in headers:
        return column
    try:
        return _behind(header, column._text[len(header) :].split(":")[1:], column._text)
    except ExoidError as error:
        raise BadArgumentError(f"--column {name}={error.what}", remedy=error.remedy) from None


def _behind(header: str, parts: list[str], text: str) -> Column:
    """Read scale, zero and unit behind a header."""
    numbers: list[float] = []
    unit = None
    for part in (part.strip() for part in parts):
        if unit is None and is_unit(part):
            unit = part
            continue
        try:
            numbers.append(float(part))
        except ValueError:
            raise BadArgumentError(f"{text}: {part!r} is neither a number nor a unit", remedy=SYNTAX) from None
    if len(numbers) > 2 or not header:
        raise BadArgumentError(f"{text}: more than scale and zero" if header else f"{text}: no header", remedy=SYNTAX)
    scale, zero = (*numbers, *(1.0, 0.0)[len(numbers) :])
    return Column(header, scale, zero, unit)
