"""What estimators ask of a regression problem: R factors, and rows that can be gone over again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .least_squares import RFactor, Solution
from .row_data import NoiseKind, RowBlock


class LeastSquaresProblem(Protocol):
    """A problem reduced to R factors, which is all that least squares asks for."""

    @property
    def names(self) -> Sequence[str]:
        """Names of the parameters."""

    @property
    def r_factors(self) -> Sequence[RFactor]:
        """R factor of the rows of each joint, in motion and at rest."""

    def solve(self, r_factor: RFactor) -> Solution:
        """Solve for rows, with what is known beside them.

        Args:
            r_factor: R factor of the weighted rows.

        Returns:
            The solution.
        """


class RowSource(Protocol):
    """Rows that can be gone over again and again, recording by recording."""

    @property
    def columns(self) -> Sequence[NDArray[np.intp]]:
        """Parameters that can act on each joint, as indices, in the order of the columns of its rows."""

    def weight_index(self, kind: NoiseKind, joint: int) -> int:
        """Index among the R factors of the one that holds the rows of a kind and joint."""

    def recordings(self) -> Iterator[RowBlock]:
        """Go over the recordings: all decimated rows of each."""


class RowProblem(LeastSquaresProblem, RowSource, Protocol):
    """A problem whose rows can be gone over again, joint by joint."""

    @property
    def joint_names(self) -> Sequence[str]:
        """Joint of each row block; groups follow each other."""

    def blocks(self) -> Iterator[RowBlock]:
        """Go over all rows in order of time, recording by recording."""
