"""Table of a log file: named columns of numbers, with the place of each row in the file."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals.source import Source
from exoid.tools.reader_process import refuse_expansion

from .bounds import refuse_columns

QUANTITIES = ("q", "v", "a", "tau", "i", "f", "tm", "qm", "temp")
"""Prefixes of column names: ``q_<joint>`` [rad], ``v_`` [rad/s], ``a_`` [rad/s²], ``tau_`` [N·m],
``i_`` [A], ``f_`` [N], of motors ``tm_`` [N·m] and ``qm_`` [rad], and ``temp_`` [°C]."""

MATRICES = {"current": "i", "force": "f", "motor_torque": "tm", "motor_angle": "qm", "temperature": "temp"}
"""Prefix of the columns of matrices with other names; any other has that of :data:`QUANTITIES`."""

OF_DRIVES = ("i", "f", "tm", "qm", "temp", *MATRICES)
"""Matrices that are of other things than joints where their width does not fit, such as forces of a force plate."""


@dataclass(frozen=True)
class ReadOptions:
    """Options of the caller that some formats need before a file can be read.

    Attributes:
        joint_names: Joints to read; None for those in the file.
        columns: Name in the file of each exoid column whose name differs; it may be followed by a scale, a zero and a
            unit, behind colons (:func:`header_in`).
        topic: Topic of a bag; None for the only one of joint states.
        stamps: Time stamps of a bag: "header", or "received" when the message was recorded.
        names: Names of the columns of a text file without a header line; None where it has one.
        format: Logger of an actuator and its joint, such as "moteus:knee"; None for what the header shows.
    """

    joint_names: Sequence[str] | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    topic: str | None = None
    stamps: Literal["header", "received"] = "header"
    names: Sequence[str] | None = None
    format: str | None = None

    def to_json(self) -> dict[str, Any]:
        """Describe the options by name, as values of JSON.

        Returns:
            Arguments that make equal options.
        """
        joints = self.joint_names
        return {
            "joint_names": joints if joints is None or isinstance(joints, str) else list(joints),
            "columns": dict(self.columns),
            "topic": self.topic,
            "stamps": self.stamps,
            "names": None if self.names is None else list(self.names),
            "format": self.format,
        }


def header_in(headers: Collection[str], text: str) -> str:
    """Find the header at the beginning of ``HEADER:SCALE:ZERO:UNIT``; headers may contain colons themselves.

    Args:
        headers: Headers of the file.
        text: Header, and perhaps more.

    Returns:
        The longest beginning of the text, up to a colon or its end, that is a header; all of it if there is none.
    """
    beginning = text
    while beginning not in headers and ":" in beginning:
        beginning = beginning.rpartition(":")[0]
    return beginning if beginning in headers else text


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
        """Check that columns are of one length."""
        columns = {name: np.asarray(values) for name, values in self.columns.items()}
        shapes = {values.shape for values in columns.values()}
        if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
            found = ", ".join(f"{name} {values.shape}" for name, values in list(columns.items())[:20])
            raise ExoidError(
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
        raise ExoidError(f"holds {values.dtype}, not real numbers", where=where, remedy="write numbers in SI units")
    return np.asarray(values, dtype=np.float64)


def to_columns(arrays: Mapping[str, NDArray[Any]], file: str, options: ReadOptions) -> dict[str, NDArray[Any]]:
    """Split arrays of (samples,) and (samples, joints) into named columns; ``time`` gives the number of samples."""
    # A matrix q becomes `q_<joint>`, with the joints of the array `joint_names` or of the caller. Any other matrix
    # becomes `name[0]`, `name[1]`, …. Arrays of another length are left out.
    time = header_in(arrays, options.columns.get("time", "time"))
    if time not in arrays:
        exists = ", ".join(f"{name} {values.shape}" for name, values in list(arrays.items())[:20]) or "nothing"
        raise ExoidError(
            f"no array {time!r} of time stamps; the file has: {exists}",
            where=file,
            remedy="rename it in the file or pass columns={'time': <name in the file>}",
            command="rename it in the file or give its name: --column time=NAME",
        )
    samples = arrays[time].size
    if samples != max(arrays[time].shape, default=1):
        raise ExoidError(f"{time} has shape {arrays[time].shape}", where=file, remedy="give one time stamp per sample")
    if not samples:
        raise ExoidError(f"{time} is empty", where=file, remedy="check that the logger closed the file")
    refuse_columns(sum(math.prod(values.shape) // samples for values in arrays.values()), file)
    named = _joint_names(arrays, file)
    for name, prefix in MATRICES.items():
        if {name, prefix} <= arrays.keys() and arrays[name].ndim == arrays[prefix].ndim == 2:
            raise ExoidError(f"both {name} and {prefix} are there", where=file, remedy="write one of them")
    columns: dict[str, NDArray[Any]] = {time: arrays[time].reshape(-1)}
    for name, values in arrays.items():
        matrix = None if name in (time, "joint_names") else _samples_first(values, samples)
        if matrix is None:
            continue
        labels = _labels(name, matrix.shape[1], named, options.joint_names, file)
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
        raise ExoidError(
            f"joint_names holds {names.dtype}, not text", where=file, remedy="write an array of strings, one per joint"
        )
    return tuple(str(name).strip() for name in np.atleast_1d(names).reshape(-1))


def _labels(
    name: str, width: int, named: Sequence[str] | None, asked: Sequence[str] | None, file: str
) -> Sequence[str]:
    """Names of the columns of one array."""
    if name in QUANTITIES or name in MATRICES:
        if named is not None and len(named) != width and name not in OF_DRIVES:
            raise ExoidError(
                f"{name} has {width} columns, but joint_names has {len(named)}: {', '.join(named[:20])}",
                where=file,
                remedy="give every joint one column, (samples, joints)",
            )
        joints = named if named is not None else asked
        if joints is not None and not isinstance(joints, str) and len(joints) == width:
            return [f"{MATRICES.get(name, name)}_{joint}" for joint in joints]
    return [name] if width == 1 else [f"{name}[{k}]" for k in range(width)]


def needs(package: str, kind: str, file: str) -> ExoidError:
    """Make the error about a package that is not installed."""
    return ExoidError(
        f"reading {kind} needs {package}", where=file, remedy="pip install 'exoid[io]', or convert to CSV"
    )
