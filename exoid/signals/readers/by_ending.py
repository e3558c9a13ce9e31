"""Readers of log files by the ending of the file's name."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, overload

from exoid.errors import ExoidError
from exoid.tools.reader_process.reading import reading
from exoid.tools.registry import Registry

from .mat import read_mat
from .npz import read_npz
from .opensim import read_opensim_table
from .options import ReadRequest
from .parquet import read_parquet
from .rosbag import read_rosbag
from .table import Table
from .text import read_text_table

Reader = Callable[[str, ReadRequest], Table]
"""Function that reads a log, of its path as the caller gave it and of the options."""

AnyReader = TypeVar("AnyReader", bound=Reader)

REMEDY = "check that the file is complete, and of the format that the reader expects"


def _check(reader: Reader) -> None:
    """Refuse what cannot be called."""
    if not callable(reader):
        raise ExoidError(f"{reader!r} is no reader of logs", remedy="pass a function of a path and exoid's ReadRequest")


READERS: Registry[Reader] = Registry("log format", "exoid.formats", "exoid.signals.register_format", _check)
"""Readers by ending, without its dot: those of exoid, those that were registered, and those of installed packages."""


@overload
def register_format(ending: str) -> Callable[[AnyReader], AnyReader]: ...


@overload
def register_format(ending: str, reader: AnyReader) -> AnyReader: ...


def register_format(ending: str, reader: AnyReader | None = None) -> AnyReader | Callable[[AnyReader], AnyReader]:
    """Register the reader of log files whose names have an ending.

    :meth:`exoid.Recording.from_file`, folders of logs and the command line then read such files. A package that offers
    the reader as an entry point of the group ``exoid.formats``, named like the ending without its dot, needs no call:
    exoid finds it where the package is installed.

    Args:
        ending: End of the file's name after the last dot, in lower case, such as "lab".
        reader: Function of the path as the caller gave it and a :class:`exoid.signals.readers.ReadRequest`. It returns
            a :class:`exoid.signals.readers.Table` with columns such as ``time`` [s], ``q_<joint>`` [rad] and
            ``tau_<joint>`` [N·m], usually an :class:`exoid.signals.readers.ArrayTable`. None for a decorator.

    Returns:
        The reader as it is, or the decorator.

    Raises:
        ExoidError: The ending has a reader already, or is none.

    Example:
        >>> @register_format("plain")
        ... def read_plain(file, options):
        ...     time, q, tau = np.loadtxt(file, unpack=True)
        ...     columns = {"time": time, "q_knee": q, "tau_knee": tau}
        ...     return ArrayTable(file, Source.of(Path(file)), columns)
    """
    plain = ending.removeprefix(".") if isinstance(ending, str) else ending
    if isinstance(plain, str) and (plain != plain.lower() or "." in plain):
        raise ExoidError(
            f"{ending!r} is no ending of a file's name", remedy='give what follows the last dot in lower case: "lab"'
        )
    if reader is None:
        return lambda reader: register_format(ending, reader)
    READERS.register(plain, reader)
    return reader


for _reader, _endings in (
    (read_text_table, ("csv", "tsv", "txt")),
    (read_opensim_table, ("mot", "sto")),
    (read_npz, ("npz",)),
    (read_mat, ("mat",)),
    (read_parquet, ("parquet",)),
    (read_rosbag, ("bag", "db3", "mcap")),
):
    for _ending in _endings:
        READERS.register(_ending, _reader)

BUILT_IN = frozenset(READERS.registered)
"""Endings that exoid reads itself."""


def read_as(ending: str, file: str, request: ReadRequest) -> Table:
    """Read a log by the reader of an ending."""
    reader = READERS.find(ending)
    if ending in BUILT_IN:
        return reader(file, request)
    with reading(file, f"a log of the format {ending!r}", REMEDY):
        table = reader(file, request)
    if not isinstance(table, Table):
        raise ExoidError(
            f"the reader of the format {ending!r} returned {type(table).__name__}",
            where=file,
            remedy="let it return exoid.signals.readers.ArrayTable(file, Source.of(Path(file)), columns)",
        )
    return table
