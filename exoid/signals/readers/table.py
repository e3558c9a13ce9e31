"""Table of a log file: named columns of numbers, with the place of each row in the file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError, UnreadableInputError
from exoid.signals.column import header_in
from exoid.signals.quantities import QUANTITIES
from exoid.signals.source import Source
from exoid.tools.reader_process.bounds import refuse_expansion

from .options import ReadRequest

MOST_COLUMNS = 10_000
"""Largest number of columns of a log; humanoids have some hundreds."""

MOST_BLANK_LINES = 1_000_000
"""Largest number of blank lines and comments beyond one for each line with data."""


def refuse_columns(count: int, file: str) -> None:
    """Refuse a file with more columns than any log has."""
    if count > MOST_COLUMNS:
        raise UnreadableInputError(
            f"{count} columns, more than {MOST_COLUMNS}", where=file, remedy="write the columns of one leg's joints"
        )


MATRICES = {name: quantity for quantity in QUANTITIES for name in (quantity.field, quantity.prefix)}
"""Quantity of the columns of a matrix, by its name."""


@runtime_checkable
class Table(Protocol):
    """Columns of a log file, not yet checked."""

    @property
    def file(self) -> str:
        """Path as the caller gave it, for messages."""
        ...

    @property
    def source(self) -> Source:
        """Name and SHA-256 of the file."""
        ...

    @property
    def header(self) -> tuple[str, ...]:
        """Column names in the order of the file."""
        ...

    @property
    def lines(self) -> NDArray[np.int64] | None:
        """Number of each row in the file, (N,); None where rows count from 0."""
        ...

    @property
    def row_name(self) -> str:
        """Word for a row: "line", "row" or "message"."""
        ...

    def __len__(self) -> int: ...

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; NaN and infinity are allowed.

        Args:
            columns: Names of k columns.

        Returns:
            Numbers, (N, k).

        Raises:
            ExoidError: A column does not hold numbers.
        """
        ...


@dataclass(frozen=True, eq=False)
class ArrayTable:
    """A table whose columns are in memory; attributes as those of :class:`Table`.

    Attributes:
        columns: The columns by name, all of one length, (N,).

    Raises:
        ExoidError: Columns are not of one length.
    """

    file: str
    source: Source
    columns: Mapping[str, NDArray[Any]]
    lines: NDArray[np.int64] | None = None
    row_name: str = "row"

    def __post_init__(self) -> None:
        columns = {name: np.asarray(values) for name, values in self.columns.items()}
        shapes = {values.shape for values in columns.values()}
        if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
            found = ", ".join(f"{name} {values.shape}" for name, values in list(columns.items())[:20])
            raise UnreadableInputError(
                f"columns are not of one length: {found}", where=self.file, remedy="give each one number a sample"
            )
        object.__setattr__(self, "columns", columns)

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self.columns)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def numbers(self, columns: Sequence[str]) -> FloatArray:
        """Read columns; dates become seconds since the first one."""
        if Path(self.file).exists():
            refuse_expansion(8 * len(self) * len(columns), Path(self.file), self.file)
        return np.column_stack([self._column(name) for name in columns])

    def _column(self, name: str) -> FloatArray:
        return as_column(self.columns[name], f"{self.file}, column {name}")


def as_column(values: NDArray[Any], where: str) -> FloatArray:
    """Convert an array of any real type, or of dates or durations, to float64; dates become seconds since the first."""
    if values.dtype.kind in "mM":
        ticks, missing = values.astype(f"{values.dtype.kind}8[ns]").astype(np.int64), np.isnat(values)
        first = ticks[0] if values.dtype.kind == "M" and len(ticks) else 0
        return np.where(missing, np.nan, (ticks - first) / 1e9)
    if values.dtype.kind not in "biuf":
        raise UnreadableInputError(
            f"holds {values.dtype}, not real numbers", where=where, remedy="write numbers in SI units"
        )
    return np.asarray(values, dtype=np.float64)


def to_columns(arrays: Mapping[str, NDArray[Any]], file: str, request: ReadRequest) -> dict[str, NDArray[Any]]:
    """Split arrays of (samples,) and (samples, joints) into named columns; ``time`` gives the number of samples."""
    # A matrix q becomes `q_<joint>`, with the joints of the array `joint_names` or of the caller. Any other matrix
    # becomes `name[0]`, `name[1]`, …. Arrays of another length are left out.
    time = header_in(arrays, request.get("columns", {}).get("time", "time"))
    if time not in arrays:
        exists = ", ".join(f"{name} {values.shape}" for name, values in list(arrays.items())[:20]) or "nothing"
        raise UnreadableInputError(
            f"no array {time!r} of time stamps; the file has: {exists}",
            where=file,
            remedy="rename it in the file or pass columns={'time': <name in the file>}",
            command="rename it in the file or give its name: --column time=NAME",
        )
    samples = arrays[time].size
    if samples != max(arrays[time].shape, default=1):
        raise UnreadableInputError(
            f"{time} has shape {arrays[time].shape}", where=file, remedy="give one time stamp per sample"
        )
    if not samples:
        raise UnreadableInputError(f"{time} is empty", where=file, remedy="check that the logger closed the file")
    refuse_columns(sum(math.prod(values.shape) // samples for values in arrays.values()), file)
    named = _joint_names(arrays, file)
    for name, prefix, *_ in QUANTITIES:
        if name != prefix and {name, prefix} <= arrays.keys() and arrays[name].ndim == arrays[prefix].ndim == 2:
            raise UnreadableInputError(f"both {name} and {prefix} are there", where=file, remedy="write one of them")
    columns: dict[str, NDArray[Any]] = {time: arrays[time].reshape(-1)}
    for name, values in arrays.items():
        matrix = None if name in (time, "joint_names") else _samples_first(values, samples)
        if matrix is None:
            continue
        labels = _labels(name, matrix.shape[1], named, request.get("joint_names"), file)
        columns.update(zip(labels, matrix.T, strict=True))
    return columns


def _samples_first(values: NDArray[Any], samples: int) -> NDArray[Any] | None:
    """Transpose an array so that samples are rows; None if no axis is as long as time."""
    if values.ndim == 1:
        values = values[:, np.newaxis]
    if values.ndim != 2 or samples not in values.shape or not values.size:
        return None
    return values if len(values) == samples else values.T


def _joint_names(arrays: Mapping[str, NDArray[Any]], file: str) -> tuple[str, ...] | None:
    names = arrays.get("joint_names")
    if names is None:
        return None
    if names.dtype.kind != "U":
        raise UnreadableInputError(
            f"joint_names holds {names.dtype}, not text", where=file, remedy="write an array of strings, one per joint"
        )
    return tuple(str(name).strip() for name in np.atleast_1d(names).reshape(-1))


def _labels(
    name: str, width: int, named: Sequence[str] | None, asked: Sequence[str] | None, file: str
) -> Sequence[str]:
    """Names of the columns of one array."""
    if name in MATRICES:
        if named is not None and len(named) != width and not MATRICES[name].of_drive:
            raise UnreadableInputError(
                f"{name} has {width} columns, but joint_names has {len(named)}: {', '.join(named[:20])}",
                where=file,
                remedy="give every joint one column, (samples, joints)",
            )
        joints = named if named is not None else asked
        if joints is not None and not isinstance(joints, str) and len(joints) == width:
            return [f"{MATRICES[name].prefix}_{joint}" for joint in joints]
    return [name] if width == 1 else [f"{name}[{k}]" for k in range(width)]


def needs(package: str, kind: str, file: str) -> ExoidError:
    """Make the error about a package that is not installed."""
    return ExoidError(
        f"reading {kind} needs {package}", where=file, remedy="pip install 'exoid[io]', or convert to CSV"
    )
