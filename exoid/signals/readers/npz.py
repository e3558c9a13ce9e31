"""NumPy archives: ``np.savez("log.npz", time=..., q=..., tau=..., joint_names=[...])``."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from exoid.signals.source import Source
from exoid.tools.reader_process.bounds import refuse_expansion
from exoid.tools.reader_process.reading import reading

from .bounds import refuse_columns
from .options import ReadRequest
from .table import ArrayTable, to_columns

REMEDY = "write it with np.savez(path, time=..., q=..., tau=..., joint_names=[...]), all arrays of numbers or text"


def read_npz(file: str, request: ReadRequest) -> ArrayTable:
    """Read an archive of arrays; pickled arrays are refused, because unpickling runs code from the file."""
    path = Path(file)
    with reading(file, "a NumPy archive", REMEDY):
        with zipfile.ZipFile(path) as archive:
            refuse_columns(len(archive.infolist()), file)
            refuse_expansion(sum(member.file_size for member in archive.infolist()), path, file)
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: np.asarray(data[name]) for name in data.files}
        return ArrayTable(file, Source.of(path), to_columns(arrays, file, request))
