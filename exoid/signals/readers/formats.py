"""Formats of log files: one table of readers, and how the first bytes or the ending of a file tell which."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, overload

from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.tools.reader_process.bounds import reading
from exoid.tools.registry import Registry

from .arrays import read_mat, read_npz
from .opensim import read_opensim_table
from .options import ReadRequest
from .parquet import read_parquet
from .rosbag import read_rosbag
from .table import Table
from .text import read_text_table

Reader = Callable[[str, ReadRequest], Table]
"""Function that reads a log, of its path as the caller gave it and of the options."""

AnyReader = TypeVar("AnyReader", bound=Reader)

TEXT, BAGS = ("csv", "tsv", "txt"), ("bag", "db3", "mcap")

BUILT_IN: dict[str, Reader] = {
    **dict.fromkeys(TEXT, read_text_table),
    **dict.fromkeys(("mot", "sto"), read_opensim_table),
    "npz": read_npz,
    "mat": read_mat,
    "parquet": read_parquet,
    **dict.fromkeys(BAGS, read_rosbag),
}
"""Readers of exoid by the ending of the file's name."""

MARKS = {
    b"PAR1": "parquet",
    b"PK\x03\x04": "npz",
    b"PK\x05\x06": "npz",
    b"\x93NUMPY": "npy",
    b"\x89MCAP": "mcap",
    b"SQLite format 3\0": "db3",
    b"#ROSBAG": "bag",
    b"\x89HDF\r\n\x1a\n": "hdf5",
    b"MATLAB 5.0": "mat",
    b"MATLAB 7.3": "hdf5",
}
"""Ending of the kind of file that begins with these bytes."""

NO_ANGLES = ("markers, not joint angles", "let OpenSim's inverse kinematics make a .mot of them; plates: --forces")

REFUSED = {
    **dict.fromkeys(("c3d", "trc"), NO_ANGLES),
    "npy": ("a single array", "write a log with np.savez(path, time=..., q=..., tau=..., joint_names=[...])"),
    "hdf5": ("an HDF5 file, such as MATLAB writes as version 7.3", "save it with '-v7', or as CSV or Parquet"),
}


def _check(reader: Reader) -> None:
    """Refuse what cannot be called."""
    if not callable(reader):
        raise BadArgumentError(
            f"{reader!r} is no reader of logs", remedy="pass a function of a path and exoid's ReadRequest"
        )


READERS: Registry[Reader] = Registry("log format", "exoid.formats", "exoid.signals.register_format", _check)
"""Readers by ending, without its dot: those of exoid, those that were registered, and those of installed packages."""

for _ending, _reader in BUILT_IN.items():
    READERS.register(_ending, _reader)


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
        raise BadArgumentError(
            f"{ending!r} is no ending of a file's name", remedy='give what follows the last dot in lower case: "lab"'
        )
    if reader is None:
        return lambda reader: register_format(ending, reader)
    READERS.register(plain, reader)
    return reader


def open_table(path: str | os.PathLike[str], request: ReadRequest | None = None, kind: str | None = None) -> Table:
    """Open a log of any kind that exoid reads, or that :func:`register_format` registered."""
    request, file = request or {}, os.fsdecode(path)
    kind, stamps = kind or kind_of(Path(file)), request.get("stamps", "header")
    if kind not in BAGS and (request.get("topic") is not None or stamps != "header"):
        what, command = "topic and stamps apply to bags only", "leave out --topic and --received"
        raise BadArgumentError(what, remedy="leave them out", command=command)
    if kind not in TEXT and request.get("names") is not None:
        what, command = "names are those of a text file without a header line", "leave out --names"
        raise BadArgumentError(what, remedy="leave them out: this file names its columns", command=command)
    if stamps not in ("header", "received"):
        raise BadArgumentError(f"stamps is {stamps!r}", remedy='pass stamps="header" or stamps="received"')
    if kind in REFUSED:
        what, remedy = REFUSED[kind]
        raise NotSupportedError(what, remedy=remedy)
    remedy = "check that the file is complete, and of the format that the reader expects"
    with reading(f"a log of the format {kind!r}", remedy):
        table = READERS.find(kind)(file, request)
    if not isinstance(table, Table):
        raise NotSupportedError(
            f"the reader of the format {kind!r} returned {type(table).__name__}",
            remedy="let it return exoid.signals.readers.ArrayTable(file, Source.of(Path(file)), columns)",
        )
    return table


def kind_of(path: Path) -> str:
    """Tell the kind of a log: its ending if that was registered, else its first bytes, else its ending."""
    # Registered endings of other packages are checked before the first bytes, because formats may be based on zip or
    # HDF5. Endings of exoid are checked after them: they decide for damaged files, and for MATLAB files of version 4.
    # Any other file is text, whose reader reports files that cannot be read.
    try:
        if path.is_dir():
            if (path / "metadata.yaml").is_file():
                return "bag"
            raise UnreadableInputError(
                "is a directory, not a file", remedy="name a file in it; a folder is a log only if it is a rosbag2"
            )
        if not path.is_file():
            return "csv"
        with path.open("rb") as opened:
            first = opened.read(max(map(len, MARKS)))
    except (OSError, ValueError):
        return "csv"
    ending = path.suffix.lower().removeprefix(".")
    if ending and ending not in BUILT_IN and ending in READERS:
        return ending
    found = next((kind for mark, kind in MARKS.items() if first.startswith(mark)), ending if first else "")
    return found if found in BUILT_IN or found in REFUSED else "csv"
