"""What belongs to the samples of a recording: arrays with one row a sample."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from exoid._typing import BoolArray, FloatArray

if TYPE_CHECKING:
    from typing_extensions import Self


class Sampled(ABC):
    """Measurements at the samples of a recording, which select and resample themselves."""

    @abstractmethod
    def rows(self, rows: slice | BoolArray) -> Self:
        """Select samples."""

    @abstractmethod
    def interpolated(self, time: FloatArray, grid: FloatArray, rows: slice | BoolArray = slice(None)) -> Self:
        """Interpolate at other time stamps."""

    @abstractmethod
    def averaged(self, size: int) -> Self:
        """Average neighbouring samples."""


def means(columns: FloatArray, size: int) -> FloatArray:
    """Means of groups of samples; samples that do not fill a group are left out."""
    count = len(columns) // size * size
    averages: FloatArray = columns[:count].reshape(-1, size, columns.shape[1]).mean(axis=1)
    return averages
