"""Rows of the least-squares problem, the kinds of their noise, and the file in which they wait for the next pass."""

from __future__ import annotations

import os
import pickle
import tempfile
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError


class TakenOut(NamedTuple):
    """Part of the rows of a joint that was projected out, as the friction in it is not known."""

    table: FloatArray  # that part of [W τ], in an orthonormal basis, (M, P + 1)
    noise_left: float  # share of the noise that is left in the rows


class Rows(NamedTuple):
    """Both sides of τ = W β for samples and joints of one recording, filtered alike, ends removed.

    Attributes:
        time: [s], (N,).
        W: Regressor, (N, n, P).
        tau: Measured torque less that of payloads [N·m], (N, n).
        q: Angle [rad], (N, n).
        v: Velocity [rad/s], (N, n).
        usable: Mask of samples of each joint that may be fitted, (N, n).
        acting: Mask of parameters that can act on each joint, (n, P); the regressor is zero elsewhere.
        independent_fraction: Share of the rows that carry independent noise; a low-pass leaves fewer.
        stands_for: Number of rows that each of these stands for; 1 unless decimated.
        reversals: What was taken out at the reversals of each joint; empty for nothing.
        known: Torque of payloads less that of measured wrenches, filtered alike [N·m], (N, n); None without both. Added
            to both sides, it gives the torque that was measured.
    """

    time: FloatArray
    W: FloatArray
    tau: FloatArray
    q: FloatArray
    v: FloatArray
    usable: NDArray[np.bool_]
    acting: NDArray[np.bool_]
    independent_fraction: float
    stands_for: float = 1.0
    reversals: tuple[TakenOut, ...] = ()
    known: FloatArray | None = None

    @property
    def of_samples(self) -> dict[str, Any]:
        """Arrays with a row for each sample, by name."""
        return {name: x for name, x in self._asdict().items() if isinstance(x, np.ndarray) and name != "acting"}


class NoiseKind(NamedTuple):
    """Rows whose torque noise is of one kind."""

    at_rest: bool  # poses, whose noise is independent from one to the next
    # logarithm of the sampling interval, in steps of a tenth: recordings of one class share a noise model
    rate_class: int


class RowBlock(NamedTuple):
    """Consecutive rows of one recording, or all that are left after decimation, and the kind of their noise."""

    kind: NoiseKind
    rows: Rows
    first: int = 0  # index of the first joint of the rows among those of the problem


class RowsFile:
    """Rows of one recording, written once and read as often as wanted; gone with the object."""

    def __init__(self, rows: Rows) -> None:
        """Write them to a file that has no name."""
        try:
            self._file = tempfile.TemporaryFile(prefix="exoid-")  # noqa: SIM115 - closed with the last reference
            pickle.dump(rows, self._file, protocol=pickle.HIGHEST_PROTOCOL)
            self._file.flush()
        except OSError as problem:
            raise ExoidError(
                f"temporary rows cannot be written: {problem.strerror or problem}",
                where=os.environ.get("TMPDIR", ""),
                remedy="free space there, or name another folder by the environment variable TMPDIR",
            ) from None

    def read(self) -> Rows:
        """Read them."""
        self._file.seek(0)
        rows: Rows = pickle.load(self._file)
        return rows
