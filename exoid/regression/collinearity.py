"""Parameters that move together: near-dependencies of the regressor's columns, after Belsley, Kuh and Welsch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

ILL_CONDITIONED = 100.0
"""Beyond this condition index an error of a thousandth of the torque may grow to a tenth of that of a parameter,"""

HOPELESS = 300.0
"""and beyond this to a third."""

LARGEST = 1e100
"""Condition indices are cut off here."""

HALF = 0.5
"""A parameter belongs to the directions that make up this part of its variance."""

NAMED = 3
"""So many groups of parameters are named."""

INVOLVED = 0.2
"""A column with at least this part in a direction is named with it."""


class Direction(NamedTuple):
    """Parameters whose columns nearly cancel each other, those most involved first.

    Attributes:
        condition: Its condition index, the largest singular value of the unit-column regressor over its own.
        columns: Their indices.
    """

    condition: float
    columns: tuple[int, ...]


class Collinearity(NamedTuple):
    """What a least-squares problem says on parameters that it can hardly tell apart.

    Attributes:
        indices: Condition index of each parameter: at least half of its variance comes from directions of this index
            or worse, (P,); 1 for known parameters.
        directions: Those beyond :data:`ILL_CONDITIONED`, the worst first.
    """

    indices: FloatArray = np.ones(0)
    directions: tuple[Direction, ...] = ()

    @classmethod
    def of(cls, sigma: FloatArray, Vt: FloatArray, places: NDArray[np.intp], count: int) -> Collinearity:
        """Look at the singular value decomposition of a unit-column regressor.

        With singular values σ_k and right vectors v_k a parameter's variance is Σ_k v_ik² / σ_k²: each term over the
        sum is the variance-decomposition proportion of direction k.

        Args:
            sigma: Singular values, the largest first, (p,).
            Vt: Right singular vectors, (p, p).
            places: Of the columns among all parameters, (p,).
            count: Of all parameters, P.
        """
        worst_first, columns = np.minimum(sigma[0] / sigma[::-1], LARGEST), Vt[::-1]
        parts = (columns * worst_first[:, None]) ** 2
        summed = np.cumsum(parts, axis=0) / np.maximum(parts.sum(axis=0), np.finfo(np.float64).tiny)
        indices = np.ones(count)
        indices[places] = worst_first[np.argmax(summed >= HALF, axis=0)]
        directions = []
        for index, direction in zip(worst_first, np.abs(columns), strict=True):
            if index <= ILL_CONDITIONED:
                break
            order = np.argsort(-direction)
            named = [int(places[k]) for k in order if direction[k] >= INVOLVED]
            directions.append(Direction(float(index), tuple(named)))
        return cls(indices, tuple(directions))

    def warnings(self, names: Sequence[str]) -> tuple[str, ...]:
        """Name the parameters that move together, in one sentence."""
        groups = [
            f"{', '.join(names[k] for k in direction.columns)} (condition index {direction.condition:.3g})"
            for direction in self.directions
        ]
        if not groups:
            return ()
        more = f"; and {len(groups) - NAMED} other groups" if len(groups) > NAMED else ""
        return (
            f"these recordings hardly tell apart {'; '.join(groups[:NAMED])}{more}: small errors of model, sensors or "
            "filters move them together by much, so excite more, or plan a motion",
        )
