"""Kind of a log file: given by a registered ending, else by its first bytes, else by its name."""

from __future__ import annotations

import os
from pathlib import Path

from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError

from .by_ending import BUILT_IN, READERS, read_as
from .loggers import read_with_format
from .options import ReadRequest
from .table import Table

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

TEXT = "csv"
"""Kind of any other file; the text reader reports files that cannot be read."""

REFUSED = {
    "npy": ("a single array", "write a log with np.savez(path, time=..., q=..., tau=..., joint_names=[...])"),
    "hdf5": ("an HDF5 file, such as MATLAB writes as version 7.3", "save it with '-v7', or as CSV or Parquet"),
}


def open_table(path: str | os.PathLike[str], request: ReadRequest | None = None, kind: str | None = None) -> Table:
    """Open a log of any kind that exoid reads, or that :func:`register_format` registered."""
    request, file = request or {}, os.fsdecode(path)
    kind, stamps = kind or kind_of(Path(file), file), request.get("stamps", "header")
    if kind not in ("bag", "db3", "mcap") and (request.get("topic") is not None or stamps != "header"):
        what, command = "topic and stamps apply to bags only", "leave out --topic and --received"
        raise BadArgumentError(what, where=file, remedy="leave them out", command=command)
    if kind not in ("csv", "tsv", "txt") and request.get("names") is not None:
        what, command = "names are those of a text file without a header line", "leave out --names"
        raise BadArgumentError(what, where=file, remedy="leave them out: this file names its columns", command=command)
    if stamps not in ("header", "received"):
        raise BadArgumentError(f"stamps is {stamps!r}", remedy='pass stamps="header" or stamps="received"')
    if kind in REFUSED:
        what, remedy = REFUSED[kind]
        raise NotSupportedError(what, where=file, remedy=remedy, file=file)
    return read_with_format(read_as(kind, file, request), request)


def kind_of(path: Path, file: str) -> str:
    """Tell the kind of a log."""
    # Registered endings of other packages are checked before the first bytes, because formats may be based on zip or
    # HDF5. Endings of exoid are checked after them: they decide for damaged files, and for MATLAB files of version 4.
    try:
        if path.is_dir():
            return _kind_of_folder(path, file)
        if not path.is_file():
            return TEXT
        with path.open("rb") as opened:
            first = opened.read(max(map(len, MARKS)))
    except (OSError, ValueError):
        return TEXT
    ending = path.suffix.lower().removeprefix(".")
    if ending and ending not in BUILT_IN and ending in READERS:
        return ending
    for mark, kind in MARKS.items():
        if first.startswith(mark):
            return kind
    return ending if first and ending in BUILT_IN else TEXT


def _kind_of_folder(path: Path, file: str) -> str:
    if (path / "metadata.yaml").is_file():
        return "bag"
    raise UnreadableInputError(
        "is a directory, not a file", where=file, remedy="name a file in it; a folder is a log only if it is a rosbag2"
    )
