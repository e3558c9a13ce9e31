"""What estimators ask of a regression problem: R factors, and rows that can be gone over again; and what they find."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

from .least_squares import RFactor, Solution
from .noise import AutoregressiveNoise
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

    def blocks(self) -> Iterator[RowBlock]:
        """Go over all rows in order of time, recording by recording."""


Noises = Mapping[tuple[NoiseKind, int], AutoregressiveNoise]
"""Noise of each kind and joint, in units of the weighted rows."""


class Uncertainty(NamedTuple):
    """Covariance of parameters, and the noise that it is for."""

    covariance: FloatArray  # (P, P)
    dofs: FloatArray | None  # degrees of freedom of each variance, (P,); None where the number of samples gives them
    noises: Noises  # noise of the rows of each kind and joint


class Fit(NamedTuple):
    """Solution of an estimator, and how rows were weighted.

    Attributes:
        solution: Solution, with its covariance for white noise.
        weights: Weight of the rows of each R factor.
        clip: Limit of weighted residuals, beyond which they count as the limit.
        warnings: Warnings for the reader.
        uncertainty: Uncertainty for correlated noise where other rows than those of the problem were fitted; None to
            find it in the residuals.
        name: Name of the estimator with the settings that it chose; "" for its own name.
    """

    solution: Solution
    weights: Sequence[float]
    clip: float = np.inf
    warnings: tuple[str, ...] = ()
    uncertainty: Uncertainty | None = None
    name: str = ""
