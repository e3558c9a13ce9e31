"""Arrays in NumPy archives and in MATLAB files up to version 7: variables, or the fields of one struct."""

from __future__ import annotations

import warnings
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid.errors import UnreadableInputError
from exoid.signals.source import Source
from exoid.tools.reader_process.bounds import reading, refuse_expansion
from exoid.tools.reader_process.child import Content, read_in_child

from .options import ReadRequest, as_json
from .table import ArrayTable, refuse_columns, to_columns

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


MATLAB_REMEDY = "save it from MATLAB with save(file, 'time', 'q', 'tau', 'joint_names', '-v7')"


def read_mat(file: str, request: ReadRequest) -> ArrayTable:
    """Read numbers and text; other variables are skipped. Rows count from 1, as in MATLAB."""
    with reading(file, "a MATLAB file", MATLAB_REMEDY):
        columns = read_in_child(mat_columns, file, request=as_json(request)).arrays
        rows = len(next(iter(columns.values())))
        return ArrayTable(file, Source.of(Path(file)), columns, np.arange(1, rows + 1))


def mat_columns(file: str, request: ReadRequest) -> Content:
    """Read the columns in this process, which scipy's compiled reader may end."""
    path = Path(file)
    with reading(file, "a MATLAB file", MATLAB_REMEDY), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        content = scipy.io.loadmat(path, appendmat=False, simplify_cells=True, chars_as_strings=True)
        variables = {name: value for name, value in content.items() if not name.startswith("__")}
        refuse_expansion(sum(value.nbytes for value in variables.values() if isinstance(value, np.ndarray)), path, file)
        if len(variables) == 1 and isinstance(only := next(iter(variables.values())), dict):
            variables = only
        return Content(to_columns(_flat(variables, file), file, request))


def _flat(variables: Mapping[str, Any], file: str, depth: int = 0) -> dict[str, NDArray[Any]]:
    """Name the fields of structs ``struct.field``; cells of text become arrays of text."""
    if depth > 20:
        raise UnreadableInputError("structs are nested more than 20 deep", where=file, remedy=MATLAB_REMEDY)
    found: dict[str, NDArray[Any]] = {}
    for name, value in variables.items():
        if isinstance(value, dict):
            inner = _flat(value, file, depth + 1)
            found.update({f"{name}.{field}": array for field, array in inner.items()})
            continue
        array = np.asarray(value) if not isinstance(value, list) else np.array(value, dtype=object)
        if array.dtype.kind == "O" and array.size and all(isinstance(item, str) for item in array.flat):
            array = np.array([str(item) for item in array.flat])
        if array.dtype.kind in "biufU":
            found[name] = array
    return found
