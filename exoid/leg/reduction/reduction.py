"""Linear map from Pinocchio's ten parameters per link to base parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray

LINK_PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Names of a link's dynamic parameters π in Pinocchio's order; mc in kg·m, I in kg·m² about the joint frame."""

LINK_UNITS = ("kg", *3 * ("kg·m",), *6 * ("kg·m²",))


@dataclass(frozen=True, eq=False, repr=False)
class Reduction:
    """Reduction of link parameters π to base parameters β = K π, with Y π = (Y S) (K π) for every motion."""

    names: tuple[str, ...]  # names of the base parameters, (p,)
    units: tuple[str, ...]  # units of the base parameters, (p,)
    collect: FloatArray  # matrix K from link parameters to base parameters, (p, 10 n)
    spread: FloatArray  # matrix S from base parameters to link parameters, (10 n, p); K S = 1

    def __repr__(self) -> str:
        """Write one line."""
        return f"Reduction({self.collect.shape[1]} link parameters to {len(self.names)}: {', '.join(self.names)})"

    def parameters(self, link_parameters: FloatArray) -> FloatArray:
        """Reduce link parameters to base parameters, β = K π."""
        return np.asarray(self.collect @ link_parameters)

    def reduce(self, regressor: FloatArray) -> FloatArray:
        """Reduce Pinocchio's regressor, W = Y S."""
        return regressor @ self.spread

    @cached_property
    def columns(self) -> NDArray[np.intp]:
        """Columns of Pinocchio's regressor that the parameters need, in ascending order."""
        return np.flatnonzero(self.spread.any(axis=1))

    @cached_property
    def selects(self) -> bool:
        """Whether W is these columns as they are."""
        return np.array_equal(self.spread[self.columns], np.eye(self.spread.shape[1]))

    def adjust(self, link_parameters: FloatArray, values: FloatArray) -> FloatArray:
        """Change link parameters so that they reduce to given values exactly: π + S (β − K π)."""
        # The result gives the right torque for every motion. Single links may be physically inconsistent.
        return np.asarray(link_parameters + self.spread @ (values - self.collect @ link_parameters))
