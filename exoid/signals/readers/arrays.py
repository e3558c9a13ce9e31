"""Arrays in NumPy archives and in MATLAB files up to version 7: variables, or the fields of one struct."""

from __future__ import annotations

import math
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid.errors import UnreadableInputError
from exoid.signals.quantities import QUANTITIES
from exoid.tools.file_bounds import reading, refuse_expansion
from exoid.tools.reader_process import read_in_child

from .options import ReadRequest
from .table import Table, array_table, refuse_columns

MATRICES = {name: quantity for quantity in QUANTITIES for name in (quantity.field, quantity.prefix)}
"""Quantity of the columns of a matrix, by its name."""

REMEDY = "write it with np.savez(path, time=..., q=..., tau=..., joint_names=[...]), all arrays of numbers or text"


def read_npz(file: str, request: ReadRequest) -> Table:
    """Read an archive of arrays; pickled arrays are refused, because unpickling runs code from the file."""
    path = Path(file)
    with reading("a NumPy archive", REMEDY):
        with zipfile.ZipFile(path) as archive:
            refuse_columns(len(archive.infolist()))
            refuse_expansion(sum(member.file_size for member in archive.infolist()), path)
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: np.asarray(data[name]) for name in data.files}
        return array_table(file, to_columns(arrays, request))


MATLAB_REMEDY = "save it from MATLAB with save(file, 'time', 'q', 'tau', 'joint_names', '-v7')"


def read_mat(file: str, request: ReadRequest) -> Table:
    """Read numbers and text; other variables are skipped. Rows count from 1, as in MATLAB."""
    with reading("a MATLAB file", MATLAB_REMEDY):
        columns = to_columns(read_in_child(mat_arrays, file), request)
        rows = len(next(iter(columns.values())))
        return array_table(file, columns, np.arange(1, rows + 1))


def mat_arrays(file: str) -> dict[str, NDArray[Any]]:
    """Read the arrays in this process, which scipy's compiled reader may end."""
    with reading("a MATLAB file", MATLAB_REMEDY), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        content = scipy.io.loadmat(file, appendmat=False, simplify_cells=True, chars_as_strings=True)
        variables = {name: value for name, value in content.items() if not name.startswith("__")}
        refuse_expansion(sum(value.nbytes for value in variables.values() if isinstance(value, np.ndarray)), Path(file))
        if len(variables) == 1 and isinstance(only := next(iter(variables.values())), dict):
            variables = only
        return _flat(variables)


def _flat(variables: Mapping[str, Any], depth: int = 0) -> dict[str, NDArray[Any]]:
    """Name the fields of structs ``struct.field``; cells of text become arrays of text."""
    if depth > 20:
        raise UnreadableInputError("structs are nested more than 20 deep", remedy=MATLAB_REMEDY)
    found: dict[str, NDArray[Any]] = {}
    for name, value in variables.items():
        if isinstance(value, dict):
            inner = _flat(value, depth + 1)
            found.update({f"{name}.{field}": array for field, array in inner.items()})
            continue
        array = np.asarray(value) if not isinstance(value, list) else np.array(value, dtype=object)
        if array.dtype.kind == "O" and array.size and all(isinstance(item, str) for item in array.flat):
            array = np.array([str(item) for item in array.flat])
        if array.dtype.kind in "biufU":
            found[name] = array
    return found


def to_columns(arrays: Mapping[str, NDArray[Any]], request: ReadRequest) -> dict[str, NDArray[Any]]:
    """Split arrays of (samples,) and (samples, joints) into named columns; ``time`` gives the number of samples."""
    # A matrix q becomes `q_<joint>`, with the joints of the array `joint_names` or of the caller. Any other matrix
    # becomes `name[0]`, `name[1]`, …. Arrays of another length are left out.
    time = request.get("columns", {}).get("time", "time")
    if time not in arrays:
        exists = ", ".join(f"{name} {values.shape}" for name, values in list(arrays.items())[:20]) or "nothing"
        raise UnreadableInputError(
            f"no array {time!r} of time stamps; the file has: {exists}",
            remedy="rename it in the file or pass columns={'time': <name in the file>}",
            command="rename it in the file or give its name: --column time=NAME",
        )
    samples = arrays[time].size
    if samples != max(arrays[time].shape, default=1):
        raise UnreadableInputError(f"{time} has shape {arrays[time].shape}", remedy="give one time stamp per sample")
    if not samples:
        raise UnreadableInputError(f"{time} is empty", remedy="check that the logger closed the file")
    refuse_columns(sum(math.prod(values.shape) // samples for values in arrays.values()))
    named = arrays.get("joint_names")
    if named is not None and named.dtype.kind != "U":
        raise UnreadableInputError(
            f"joint_names holds {named.dtype}, not text", remedy="write an array of strings, one per joint"
        )
    joints = None if named is None else tuple(str(name).strip() for name in np.atleast_1d(named).reshape(-1))
    for name, prefix, *_ in QUANTITIES:
        if name != prefix and {name, prefix} <= arrays.keys() and arrays[name].ndim == arrays[prefix].ndim == 2:
            raise UnreadableInputError(f"both {name} and {prefix} are there", remedy="write one of them")
    columns: dict[str, NDArray[Any]] = {time: arrays[time].reshape(-1)}
    for name, values in arrays.items():
        matrix = values[:, np.newaxis] if values.ndim == 1 else values
        if name in (time, "joint_names") or matrix.ndim != 2 or samples not in matrix.shape or not matrix.size:
            continue
        matrix = matrix if len(matrix) == samples else matrix.T
        labels = _labels(name, matrix.shape[1], joints, request.get("joint_names"))
        columns.update(zip(labels, matrix.T, strict=True))
    return columns


def _labels(name: str, width: int, named: Sequence[str] | None, asked: Sequence[str] | None) -> Sequence[str]:
    """Names of the columns of one array."""
    if name in MATRICES:
        if named is not None and len(named) != width and not MATRICES[name].of_drive:
            raise UnreadableInputError(
                f"{name} has {width} columns, but joint_names has {len(named)}: {', '.join(named[:20])}",
                remedy="give every joint one column, (samples, joints)",
            )
        joints = named if named is not None else asked
        if joints is not None and not isinstance(joints, str) and len(joints) == width:
            return [f"{MATRICES[name].prefix}_{joint}" for joint in joints]
    return [name] if width == 1 else [f"{name}[{k}]" for k in range(width)]
