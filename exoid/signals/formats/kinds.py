"""Which kind of log a file is: a registered ending says so, else its first bytes, and then its name."""

from __future__ import annotations

import os
from pathlib import Path

from exoid.errors import ExoidError

from .by_ending import BUILT_IN, READERS, read_as
from .table import Table, Wanted

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
"""What files begin with, and the endings of their kinds."""

LONGEST_MARK = max(map(len, MARKS))

BAGS = ("bag", "db3", "mcap")

TEXT = "csv"
"""Kind of a file that nothing says more of; its reader says what is wrong with a file that cannot be read."""

REFUSED = {
    "npy": ("a single array", "write a log with np.savez(path, time=..., q=..., tau=..., joint_names=[...])"),
    "hdf5": ("an HDF5 file, such as MATLAB writes as version 7.3", "save it with '-v7', or as CSV or Parquet"),
}


def open_table(path: str | os.PathLike[str], wanted: Wanted | None = None) -> Table:
    """Open a log of any kind that exoid reads, or that :func:`register_format` made known.

    Args:
        path: The file, or the folder of a rosbag2.
        wanted: What the caller asks for.

    Returns:
        The table.

    Raises:
        ExoidError: The file is missing, damaged, or of no such kind.
    """
    wanted, file = wanted or Wanted(), os.fsdecode(path)
    kind = kind_of(Path(file), file)
    if kind not in BAGS and (wanted.topic is not None or wanted.stamps != "header"):
        raise ExoidError("topic and stamps are of bags, which this is not", where=file, remedy="leave them out")
    if wanted.stamps not in ("header", "received"):
        raise ExoidError(f"stamps is {wanted.stamps!r}", remedy='pass stamps="header" or stamps="received"')
    if kind in REFUSED:
        what, remedy = REFUSED[kind]
        raise ExoidError(what, where=file, remedy=remedy)
    return read_as(kind, file, wanted)


def kind_of(path: Path, file: str) -> str:
    """Tell the kind of a log.

    An ending from outside exoid comes before the first bytes, as formats may be built on zip or HDF5. Endings of exoid
    come after them: they count for damaged files, and for those of MATLAB's version 4.

    Args:
        path: The file.
        file: The path as the caller gave it.

    Returns:
        Ending of the kind, such as "parquet" or "csv", or one of those that are refused.

    Raises:
        ExoidError: It is a folder, and no rosbag2.
    """
    try:
        if path.is_dir():
            return _kind_of_folder(path, file)
        if not path.is_file():
            return TEXT
        with path.open("rb") as opened:
            first = opened.read(LONGEST_MARK)
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
    raise ExoidError(
        "is a directory, not a file", where=file, remedy="name a file in it; a folder is a log only if it is a rosbag2"
    )
