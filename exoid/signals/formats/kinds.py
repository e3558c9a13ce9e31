"""Which kind of log a file is: its first bytes say so, and only where they are silent its name does."""

from __future__ import annotations

import os
from pathlib import Path

from exoid.errors import ExoidError

from .mat import read_mat
from .npz import read_npz
from .parquet import read_parquet
from .rosbag import read_rosbag
from .table import ReadOptions, Table
from .text import read_text_table

MARKS = {
    b"PAR1": "parquet",
    b"PK\x03\x04": "npz",
    b"PK\x05\x06": "npz",
    b"\x93NUMPY": "npy",
    b"\x89MCAP": "bag",
    b"SQLite format 3\0": "bag",
    b"#ROSBAG": "bag",
    b"\x89HDF\r\n\x1a\n": "hdf5",
    b"MATLAB 5.0": "mat",
    b"MATLAB 7.3": "hdf5",
}
"""What files begin with."""

NAMES = {".parquet": "parquet", ".npz": "npz", ".mat": "mat", ".mcap": "bag", ".db3": "bag", ".bag": "bag"}
"""How the names of files end whose beginning says nothing: damaged ones, and MATLAB's of version 4."""

LONGEST_MARK = max(map(len, MARKS))

REFUSED = {
    "npy": ("a single array", "write a log with np.savez(path, time=..., q=..., tau=..., joint_names=[...])"),
    "hdf5": ("an HDF5 file, such as MATLAB writes as version 7.3", "save it with '-v7', or as CSV or Parquet"),
}


def open_table(path: str | os.PathLike[str], options: ReadOptions | None = None) -> Table:
    """Open a log of any kind that exoid reads.

    Args:
        path: The file, or the folder of a rosbag2.
        options: What the caller requests.

    Returns:
        The table.

    Raises:
        ExoidError: The file is missing, damaged, or of no such kind.
    """
    options, file = options or ReadOptions(), os.fsdecode(path)
    kind = kind_of(Path(file), file)
    if kind != "bag" and (options.topic is not None or options.stamps != "header"):
        raise ExoidError("topic and stamps are of bags, which this is not", where=file, remedy="leave them out")
    if options.stamps not in ("header", "received"):
        raise ExoidError(f"stamps is {options.stamps!r}", remedy='pass stamps="header" or stamps="received"')
    if kind in REFUSED:
        what, remedy = REFUSED[kind]
        raise ExoidError(what, where=file, remedy=remedy)
    if kind == "parquet":
        return read_parquet(Path(file), file)
    if kind == "npz":
        return read_npz(Path(file), file, options)
    if kind == "mat":
        return read_mat(Path(file), file, options)
    return read_rosbag(Path(file), file, options) if kind == "bag" else read_text_table(file)


def kind_of(path: Path, file: str) -> str:
    """Tell the kind of a log: "parquet", "npz", "mat", "bag", "text", or one of those that are refused."""
    try:
        if path.is_dir():
            return _kind_of_folder(path, file)
        if not path.is_file():
            return "text"  # whose reader says what is wrong
        with path.open("rb") as opened:
            first = opened.read(LONGEST_MARK)
    except (OSError, ValueError):
        return "text"
    for mark, kind in MARKS.items():
        if first.startswith(mark):
            return kind
    return NAMES.get(path.suffix.lower(), "text") if first else "text"


def _kind_of_folder(path: Path, file: str) -> str:
    if (path / "metadata.yaml").is_file():
        return "bag"
    raise ExoidError(
        "is a directory, not a file", where=file, remedy="name a file in it; a folder is a log only if it is a rosbag2"
    )
