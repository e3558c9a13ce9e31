"""What every estimator takes and returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.identification.problem import Problem
from exoid.regression.least_squares import Solution
from exoid.regression.residuals import Noises, Point


class Fit(NamedTuple):
    """A solution and how it was come by.

    Attributes:
        solution: Its covariance is for white noise, unless ``noises`` are given.
        weights: Of the rows of each triangle.
        clip: Weighted residuals beyond this counted as this.
        noises: The noise that the covariance is for; None if it still has to be found.
        remarks: What the reader should know.
        dofs: Degrees of freedom of each parameter's variance, (P,); None if they still have to be found.
        name: Of the estimator with the settings that it chose; "" for its own name.
    """

    solution: Solution
    weights: Sequence[float]
    clip: float = np.inf
    noises: Noises | None = None
    remarks: tuple[str, ...] = ()
    dofs: FloatArray | None = None
    name: str = ""

    @property
    def point(self) -> Point:
        """Where residuals are to be looked at."""
        return Point(self.solution.values, self.weights, self.clip)


Estimator = Callable[[Problem], Fit]
"""A function, or an object with settings such as :class:`exoid.identification.estimators.JointML`."""


def name_of(estimator: Estimator) -> str:
    """Name of an estimator, for evidence."""
    return str(getattr(estimator, "name", None) or getattr(estimator, "__name__", type(estimator).__name__))
