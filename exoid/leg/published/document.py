"""Documents as data: tables as printed, and assumptions for values that are not printed; errata are in the files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from exoid.errors import BadArgumentError
from exoid.tools.toml import parse_toml


@dataclass(frozen=True)
class Quantity:
    """Printed number."""

    value: float  # value
    unit: str  # unit as printed, `"1"` for a count
    printed: str  # digits as printed; trailing zeros show the precision


@dataclass(frozen=True)
class Assumption:
    """Assumed number that the document does not print.

    Attributes:
        value: Value.
        unit: Unit, ``"1"`` for a ratio.
        reason: Source of the number, or reason for the choice.
    """

    value: float
    unit: str
    reason: str


@dataclass(frozen=True)
class PublishedTable:
    """Table as printed.

    Attributes:
        number: Roman number.
        caption: Printed caption.
        values: Numbers by name; in a table of several columns or rows the name has a prefix, ``"left.X1"``.
    """

    number: str
    caption: str
    values: Mapping[str, Quantity]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns (or rows) such as ``("left", "right")``; empty if there is only one."""
        return tuple(dict.fromkeys(name.split(".")[0] for name in self.values if "." in name))

    def column(self, column: str) -> Mapping[str, Quantity]:
        """Return the numbers of one column.

        Args:
            column: Name of the column.

        Returns:
            Numbers by name, without the prefix of the column.

        Raises:
            ExoidError: The table does not have that column.
        """
        if column not in self.columns:
            raise BadArgumentError(
                f"there is no column {column!r}",
                where=f"Table {self.number}",
                remedy=f"choose one of {', '.join(self.columns) or 'none'}",
            )
        cells = ((name.split("."), quantity) for name, quantity in self.values.items())
        return MappingProxyType({name[-1]: quantity for name, quantity in cells if name[0] == column})


@dataclass(frozen=True)
class Document:
    """Tables and assumptions of one document.

    Attributes:
        name: Citation in this library, ``"doc. 1"``.
        title: Title.
        robot: Name of the exoskeleton.
        signs: Sign convention of torques.
        tables: Tables by Roman number.
        assumptions: Assumed numbers by name, which the document does not print.
    """

    name: str
    title: str
    robot: str
    signs: str
    tables: Mapping[str, PublishedTable]
    assumptions: Mapping[str, Assumption]


def bleex() -> Document:
    """Read document 1, on the Berkeley Lower Extremity Exoskeleton (BLEEX).

    Returns:
        Tables and assumptions.
    """
    return _read("bleex.toml")


def cuhk() -> Document:
    """Read document 2, on the CUHK-EXO.

    Returns:
        Tables and assumptions.
    """
    return _read("cuhk.toml")


@cache
def _read(file_name: str) -> Document:
    text = resources.files(__package__).joinpath(file_name).read_text(encoding="utf-8")
    content = parse_toml(text, parse_float=str)  # as text, to keep the printed digits
    assumptions = {
        name: Assumption(float(value), unit, reason) for name, (value, unit, reason) in content["assumptions"].items()
    }
    return Document(
        **content["document"],
        tables=MappingProxyType({number: _table(number, entry) for number, entry in content["tables"].items()}),
        assumptions=MappingProxyType(assumptions),
    )


def _table(number: str, entry: dict[str, Any]) -> PublishedTable:
    caption, columns = entry.pop("caption"), entry.pop("columns", [""])
    cells: dict[str, Any] = {}
    for name, cell in entry.items():
        cells |= {f"{name}.{row}": each for row, each in cell.items()} if isinstance(cell, dict) else {name: cell}
    values = {
        f"{column}.{name}".lstrip("."): Quantity(float(cell[k]), cell[-1], str(cell[k]))
        for k, column in enumerate(columns)
        for name, cell in cells.items()
        if isinstance(cell, list)  # others are words or formulas
    }
    return PublishedTable(number, caption, MappingProxyType(values))
