"""The linear map between Pinocchio's ten parameters a link and the few that experiments can determine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

LINK_PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Pinocchio's order of a link's dynamic parameters π; mc in kg·m, I in kg·m² about the joint frame."""

LINK_UNITS = ("kg", *3 * ("kg·m",), *6 * ("kg·m²",))


@dataclass(frozen=True)
class RankDecision:
    """How many parameters a regressor can see, and how clear-cut that number is.

    Attributes:
        rank: Number of base parameters.
        columns: Number of columns examined (10 a link).
        smallest_kept: Smallest singular value counted, relative to the largest.
        largest_dropped: Largest singular value not counted, relative to the largest.
        threshold: What separated them.
    """

    rank: int
    columns: int
    smallest_kept: float
    largest_dropped: float
    threshold: float

    def __str__(self) -> str:
        """Summarise in one line."""
        return (
            f"{self.rank} of {self.columns} parameters are independent: singular values "
            f"{self.smallest_kept:.1e} kept, {self.largest_dropped:.1e} dropped, threshold {self.threshold:.1e}"
        )


@dataclass(frozen=True, eq=False)
class Reduction:
    """Base parameters β = K π and the columns that go with them: Y π = (Y S) (K π) for every motion.

    Attributes:
        names: Parameter names, p of them.
        units: Their units.
        collect: K, (p, 10 n): how link parameters combine into base parameters.
        spread: S, (10 n, p): one set of link parameters for each base parameter; K S = 1.
        rank: The evidence for p, when found numerically.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    collect: FloatArray
    spread: FloatArray
    rank: RankDecision | None = None

    def parameters(self, link_parameters: FloatArray) -> FloatArray:
        """Reduce link parameters π, (10 n,), to base parameters β = K π, (p,)."""
        return np.asarray(self.collect @ link_parameters)

    def reduce(self, regressor: FloatArray) -> FloatArray:
        """Reduce Pinocchio's regressor Y, (N, n, 10 n), to W = Y S, (N, n, p)."""
        return regressor @ self.spread

    def adjust(self, link_parameters: FloatArray, values: FloatArray) -> FloatArray:
        """Change link parameters so that they reduce to ``values`` exactly: π + S (β − K π).

        The result gives the right torque for every motion; whether each link alone is physical is another question.
        """
        return np.asarray(link_parameters + self.spread @ (values - self.collect @ link_parameters))
