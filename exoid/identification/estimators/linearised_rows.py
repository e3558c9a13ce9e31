"""Rows of an estimator that fits something else than τ = W β, linearised at its solution."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.regression.row_data import NoiseKind, RowBlock, Rows
from exoid.regression.rows import rate_class

T = TypeVar("T")


class LinearisedRows(NamedTuple):
    """Weighted residuals of measured channels, such as angles and torques, and their derivatives by β."""

    columns: Sequence[NDArray[np.intp]]  # parameters that act on each channel, as indices
    recordings: Sequence[RowBlock]  # rows of each recording

    @staticmethod
    def of(recordings: Sequence[RowBlock]) -> LinearisedRows:
        """Collect recordings; poses may have the first channels only."""
        channels = max(block.rows.W.shape[1] for block in recordings)
        every = np.arange(recordings[0].rows.W.shape[2])
        return LinearisedRows([every] * channels, recordings)

    def weight_index(self, kind: NoiseKind, joint: int) -> int:
        """All rows have one weight."""
        return 0

    def gather(self, work: Callable[[Iterable[RowBlock]], T]) -> Iterator[T]:
        """Let work go over the rows of each recording."""
        for block in self.recordings:
            yield work([block])


def linearised_block(
    W: FloatArray, residual: FloatArray, values: FloatArray, time: FloatArray | None, usable: FloatArray | None = None
) -> RowBlock:
    """Make a block of the rows of one recording."""
    stamps = np.arange(len(W), dtype=np.float64) if time is None else time
    kind = NoiseKind(time is None, rate_class(stamps))
    mask = np.ones(residual.shape, dtype=np.bool_) if usable is None else usable > 0.0
    acting = np.ones(W.shape[1:], dtype=np.bool_)
    still = np.zeros_like(residual)
    return RowBlock(kind, Rows(stamps, W, residual + W @ values, still, still, mask, acting, 1.0), True, True)
