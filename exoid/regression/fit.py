"""Fit: the solution of a regression, and how the rows that gave it were weighted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray

from .least_squares import Solution
from .residuals import Noises, Point


class Fit(NamedTuple):
    """A solution and how it was come by.

    Attributes:
        solution: Its covariance is for white noise, unless ``noises`` are given.
        weights: Of the rows of each R factor.
        clip: Weighted residuals beyond this counted as this.
        noises: The noise that the covariance is for; None if it still has to be found.
        warnings: What the reader should know.
        dofs: Degrees of freedom of each parameter's variance, (P,); None if they still have to be found.
        name: Of the estimator with the settings that it chose; "" for its own name.
    """

    solution: Solution
    weights: Sequence[float]
    clip: float = np.inf
    noises: Noises | None = None
    warnings: tuple[str, ...] = ()
    dofs: FloatArray | None = None
    name: str = ""

    @property
    def point(self) -> Point:
        """Where residuals are to be looked at."""
        return Point(self.solution.values, self.weights, self.clip)
