"""Rows of the least-squares problem, and the kinds of their noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray


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
        payload: Torque of payloads, filtered alike [N·m], (N, n); None without payloads.
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
    payload: FloatArray | None = None


class NoiseKind(NamedTuple):
    """Rows whose torque noise is of one kind."""

    at_rest: bool  # poses, whose noise is independent from one to the next
    # logarithm of the sampling interval, in steps of a tenth: recordings of one class share a noise model
    rate_class: int


class RowBlock(NamedTuple):
    """Consecutive rows of one recording and the kind of their noise.

    Attributes:
        kind: Kind of the noise.
        rows: The rows.
        begins: Whether these are the first of the recording.
        ends: Whether these are the last of it.
        first: Index of the first joint of the rows among those of the problem.
    """

    kind: NoiseKind
    rows: Rows
    begins: bool
    ends: bool
    first: int = 0
