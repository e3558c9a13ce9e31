"""Formats of log files: one table of readers, and how the first bytes or the ending of a file tell which."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.tools.file_bounds import reading

from .arrays import read_mat, read_npz
from .opensim import read_opensim_table
from .options import ReadRequest
from .parquet import read_parquet
from .rosbag import read_rosbag
from .table import Table
from .text import read_text_table

TEXT, BAGS = ("csv", "tsv", "txt"), ("bag", "db3", "mcap")

READERS: dict[str, Callable[[str, ReadRequest], Table]] = {
    **dict.fromkeys(TEXT, read_text_table),
    **dict.fromkeys(("mot", "sto"), read_opensim_table),
    "npz": read_npz,
    "mat": read_mat,
    "parquet": read_parquet,
    **dict.fromkeys(BAGS, read_rosbag),
}
"""Functions that read a log, of its path as the caller gave it and of the options, by the ending of its name."""

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

MARKERS = "let OpenSim's inverse kinematics make a .mot of them, and export the force plates as .mot"

REFUSED = {
    **dict.fromkeys(("c3d", "trc"), ("markers, not joint angles", MARKERS)),
    "npy": ("a single array", "write a log with np.savez(path, time=..., q=..., tau=..., joint_names=[...])"),
    "hdf5": ("an HDF5 file, such as MATLAB writes as version 7.3", "save it with '-v7', or as CSV or Parquet"),
}
"""What files of other kinds hold, and what to do, by their ending."""


def open_table(path: str | os.PathLike[str], request: ReadRequest | None = None) -> Table:
    """Open a log of any kind that exoid reads."""
    request, file = request or {}, os.fsdecode(path)
    kind, stamps = kind_of(Path(file)), request.get("stamps", "header")
    if kind not in BAGS and (request.get("topic") is not None or stamps != "header"):
        what, command = "topic and stamps apply to bags only", "leave out --topic and --received"
        raise BadArgumentError(what, remedy="leave them out", command=command)
    if stamps not in ("header", "received"):
        raise BadArgumentError(f"stamps is {stamps!r}", remedy='pass stamps="header" or stamps="received"')
    if kind in REFUSED:
        what, remedy = REFUSED[kind]
        raise NotSupportedError(what, remedy=remedy)
    with reading(f"a log of the format {kind!r}", "check that the file is complete"):
        return READERS[kind](file, request)


def kind_of(path: Path) -> str:
    """Tell the kind of a log: its first bytes, else its ending."""
    # The ending decides for damaged files, and for MATLAB files of version 4. Any other file is text, whose reader
    # reports files that cannot be read.
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
    found = next((kind for mark, kind in MARKS.items() if first.startswith(mark)), ending if first else "")
    return found if found in READERS or found in REFUSED else "csv"
