"""Column of a log: its header in the file, with scale, zero and unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .quantities import is_number, is_unit, refuse_other_unit

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

        Numbers and a unit are taken from the end. A header that ends in a number or a unit itself, such as "pos:1", is
        followed by scale and zero: "pos:1:1:0".

        Args:
            text: The text.

        Returns:
            The column.

        Raises:
            ExoidError: There is no header, or the scale is zero.
        """
        header, unit, numbers = text.strip(), None, list[float]()
        while ":" in header:
            before, _, part = header.rpartition(":")
            if unit is None and is_unit(part):
                unit = part.strip()
            elif len(numbers) < 2 and is_number(part):
                numbers.insert(0, float(part))
            else:
                break
            header = before.strip()
        if not header:
            raise BadArgumentError(f"{text!r} has no header", remedy=SYNTAX)
        scale, zero = (*numbers, *(1.0, 0.0)[len(numbers) :])
        return Column(header, scale, zero, unit)

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
        return np.asarray(factor * (self.scale * (cells - self.zero)))

    @property
    def is_plain(self) -> bool:
        """Whether cells are taken as they are."""
        return self.unit is None and self.scale == 1.0 and self.zero == 0.0
