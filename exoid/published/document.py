"""A document as data: its tables as printed, its errata, and the assumptions it leaves to the reader."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any, NoReturn

from exoid.errors import ExoidError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


@dataclass(frozen=True)
class Quantity:
    """A printed number.

    Attributes:
        value: The number.
        unit: Its unit as printed, ``"1"`` for a count.
        printed: Its digits as printed: trailing zeros tell the precision.
    """

    value: float
    unit: str
    printed: str


@dataclass(frozen=True)
class Assumption:
    """A number that the document does not give.

    Attributes:
        value: The number.
        unit: Its unit, ``"1"`` for a ratio.
        reason: Where it comes from, or why it was chosen.
    """

    value: float
    unit: str
    reason: str


@dataclass(frozen=True)
class Erratum:
    """A misprint or a remark; it is never applied to a table.

    Attributes:
        where: The tables, equations or sections concerned, such as ``"Table I"``.
        remark: What is wrong and how this library reads it.
    """

    where: tuple[str, ...]
    remark: str


@dataclass(frozen=True)
class Table:
    """One table as printed.

    Attributes:
        number: Roman number.
        caption: Printed caption.
        equation: What the numbers are coefficients of; empty when the names say it.
        values: The numbers; in a table of several columns or rows the name begins with theirs, ``"left.X1"``.
        texts: Cells that hold words or formulas, named likewise.
        errata: The document's errata that concern this table.
    """

    number: str
    caption: str
    equation: str
    values: Mapping[str, Quantity]
    texts: Mapping[str, str]
    errata: tuple[Erratum, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns (or rows) such as ``("left", "right")``; empty when there is only one."""
        names = (*self.values, *self.texts)
        return tuple(dict.fromkeys(name.split(".")[0] for name in names if "." in name))

    def quantity(self, name: str) -> Quantity:
        """Look up one number.

        Raises:
            ExoidError: There is none of that name.
        """
        if name not in self.values:
            _unknown("quantity", name, self.values, where=f"Table {self.number}")
        return self.values[name]

    def column(self, column: str) -> Mapping[str, Quantity]:
        """Return the numbers of one column, by their names without the column's.

        Raises:
            ExoidError: There is no such column.
        """
        if column not in self.columns:
            _unknown("column", column, self.columns, where=f"Table {self.number}")
        cells = ((name.split("."), quantity) for name, quantity in self.values.items())
        return MappingProxyType({name[-1]: quantity for name, quantity in cells if name[0] == column})


@dataclass(frozen=True)
class Document:
    """One document.

    Attributes:
        name: How this library cites it, ``"doc. 1"``.
        title: Its title.
        robot: The exoskeleton it is about.
        signs: Its sign convention for torques.
        tables: Its tables by Roman number.
        errata: Misprints and remarks.
        assumptions: Numbers that it does not give and this library assumes.
    """

    name: str
    title: str
    robot: str
    signs: str
    tables: Mapping[str, Table]
    errata: tuple[Erratum, ...]
    assumptions: Mapping[str, Assumption]

    def table(self, number: str) -> Table:
        """Look up a table by its Roman number.

        Raises:
            ExoidError: There is none of that number.
        """
        if number not in self.tables:
            _unknown("table", number, self.tables, where=self.name)
        return self.tables[number]

    def assumption(self, name: str) -> Assumption:
        """Look up an assumed number.

        Raises:
            ExoidError: There is none of that name.
        """
        if name not in self.assumptions:
            _unknown("assumption", name, self.assumptions, where=self.name)
        return self.assumptions[name]


def bleex() -> Document:
    """Document 1, on the Berkeley Lower Extremity Exoskeleton (BLEEX)."""
    return _read("bleex.toml")


def cuhk() -> Document:
    """Document 2, on the CUHK-EXO."""
    return _read("cuhk.toml")


@cache
def _read(file_name: str) -> Document:
    text = resources.files(__package__).joinpath(file_name).read_text(encoding="utf-8")
    content = tomllib.loads(text, parse_float=str)  # as text, to keep the digits as printed
    errata = tuple(Erratum(tuple(entry["where"]), entry["remark"]) for entry in content["errata"])
    assumptions = {
        name: Assumption(float(value), unit, reason) for name, (value, unit, reason) in content["assumptions"].items()
    }
    return Document(
        **content["document"],
        tables=MappingProxyType({n: _table(n, entry, errata) for n, entry in content["tables"].items()}),
        errata=errata,
        assumptions=MappingProxyType(assumptions),
    )


def _table(number: str, entry: dict[str, Any], errata: tuple[Erratum, ...]) -> Table:
    caption, equation = entry.pop("caption"), entry.pop("equation", "")
    cells = dict(_flat(entry))
    quantities = {n: Quantity(float(c[0]), c[1], str(c[0])) for n, c in cells.items() if isinstance(c, list)}
    return Table(
        number=number,
        caption=caption,
        equation=equation,
        values=MappingProxyType(quantities),
        texts=MappingProxyType({name: cell for name, cell in cells.items() if isinstance(cell, str)}),
        errata=tuple(erratum for erratum in errata if f"Table {number}" in erratum.where),
    )


def _flat(entry: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Name the cells of nested tables by their path: ``left.X1``."""
    for name, cell in entry.items():
        if isinstance(cell, dict):
            yield from _flat(cell, f"{prefix}{name}.")
        else:
            yield prefix + name, cell


def _unknown(kind: str, name: str, known: Iterable[str], *, where: str) -> NoReturn:
    raise ExoidError(f"there is no {kind} {name!r}", where=where, remedy=f"choose one of {', '.join(known) or 'none'}")
